// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/video_mode.hpp"

#include <algorithm>
#include <charconv>

namespace bpa::camera {
namespace {

/// Reads a number up to `stop` (which is taken, too) off the front.
bool read_number(std::string_view& text, char stop, int& number) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  if (result.ec != std::errc() || number < 1 || number > 8192) return false;
  text.remove_prefix(static_cast<std::size_t>(result.ptr - text.data()));
  if (stop == '\0') return text.empty();
  if (text.empty() || text.front() != stop) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

std::optional<VideoMode> parse_video_mode(std::string_view text) {
  VideoMode mode;
  const bool good = read_number(text, 'x', mode.width) && read_number(text, '@', mode.height) &&
                    read_number(text, '\0', mode.fps);
  return good ? std::optional(mode) : std::nullopt;
}

std::string to_string(const VideoMode& mode) {
  return std::to_string(mode.width) + "x" + std::to_string(mode.height) + "@" +
         std::to_string(mode.fps);
}

std::string list_of(const std::vector<VideoMode>& modes) {
  std::string text;
  for (auto mode = modes.begin(); mode != modes.end(); ++mode) {
    if (std::find(modes.begin(), mode, *mode) != mode) continue;
    if (!text.empty()) text += ", ";
    text += to_string(*mode);
  }
  return text;
}

}  // namespace bpa::camera
