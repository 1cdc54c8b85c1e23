// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bpa::camera {

/// Size and rate of a stream, as settings write it: 640x480@30.
struct VideoMode {
  int width = 0;
  int height = 0;
  int fps = 0;

  bool operator==(const VideoMode& other) const {
    return width == other.width && height == other.height && fps == other.fps;
  }
};

/// Reads "640x480@30"; nothing when it does not read so or a number is not in 1 to 8192.
std::optional<VideoMode> parse_video_mode(std::string_view text);
std::string to_string(const VideoMode& mode);
/// "640x480@30, 320x240@30": each once, in this order.
std::string list_of(const std::vector<VideoMode>& modes);

}  // namespace bpa::camera
