// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/msg/diagnostic_msgs.hpp"
#include "idl/wire/participant.hpp"

namespace bpa::server {

struct CaptureOptions;
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

/// The server's own camera: its frames go to the search and to camera topics, it can be recorded by
/// a service, and diagnostics say how it is. `on_frame` and `idle` (whether no frame waits for the
/// search) are called on the capture thread.
Result<std::unique_ptr<FrameSource>> open_camera_source(const wire::Participant& participant,
                                                        const CaptureOptions& options,
                                                        OnFrame on_frame,
                                                        std::function<bool()> idle, LogHook log);

}  // namespace bpa::server
