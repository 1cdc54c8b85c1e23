// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace bpa::server {

/// How one source of frames is doing: a line of diagnostics.
struct SourceReport {
  enum class Level { ok, warning, error };

  std::string name;         ///< What it is, such as "camera topics"; unique in the server.
  std::string hardware_id;  ///< Of the device, or the topic.
  Level level = Level::ok;
  std::string message;  ///< One sentence for people.
  std::vector<std::pair<std::string, std::string>> values;
};

/// Where frames come from. It starts when it is made and hands frames to whoever made it, on
/// threads of its own, until it is destroyed.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// From any thread, at any time.
  virtual std::vector<SourceReport> reports() const = 0;
};

}  // namespace bpa::server
