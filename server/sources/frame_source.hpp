// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "idl/wire/msg/diagnostic_msgs.hpp"

namespace bpa::server {

struct IncomingFrame;

/// Takes a frame, on a thread of its source.
using OnFrame = std::function<void(IncomingFrame&&)>;

/// How one source of frames is doing. `name` is unique in the server ("camera"), `message` one
/// sentence for people, `hardware_id` the device or the topic.
using SourceReport = wire::diagnostic_msgs::DiagnosticStatus;

/// Where frames come from. It starts when it is made and hands frames to its owner, on threads
/// of its own, until it is destroyed.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// From any thread, at any time.
  virtual std::vector<SourceReport> reports() const = 0;
};

}  // namespace bpa::server
