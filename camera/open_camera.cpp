// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/open_camera.hpp"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

namespace bpa::camera {
namespace {

constexpr std::string_view kOpenni2 = "openni2";
constexpr std::string_view kOneOfOpenni2 = "openni2:";
constexpr std::string_view kBop = "bop:";

}  // namespace

std::optional<VideoMode> parse_video_mode(const std::string& text) {
  VideoMode mode;
  std::sscanf(text.c_str(), "%4dx%4d@%4d", &mode.width, &mode.height, &mode.fps);
  const auto [least, most] = std::minmax({mode.width, mode.height, mode.fps});
  // Reading skips spaces and ignores what follows; writing does not.
  const bool good = least >= 1 && most <= 8192 && to_string(mode) == text;
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
    text += (text.empty() ? "" : ", ") + to_string(*mode);
  }
  return text;
}

Status check(const CameraOptions& options) {
  const std::string& source = options.source;
  if (!source.empty() && source != kOpenni2 && !source.starts_with(kOneOfOpenni2) &&
      !source.starts_with(kBop) && !is_recording(source)) {
    return invalid_argument("capture.source is \"" + source +
                            "\"; it must be openni2, openni2:URI, a FILE.oni, bop:FOLDER or empty");
  }
  for (const auto& [field, mode] : {std::pair("capture.depth_mode", options.depth_mode),
                                    std::pair("capture.color_mode", options.color_mode)}) {
    if (parse_video_mode(mode)) continue;
    return invalid_argument(std::string(field) + " is \"" + mode + "\"; it must read 640x480@30");
  }
  for (const char* choice : {"auto", "device", "software", "off"}) {
    if (options.registration == choice) return {};
  }
  return invalid_argument("capture.registration is \"" + options.registration +
                          "\"; it must be one of auto, device, software, off");
}

Result<OpenCamera> camera_of(const CameraOptions& options, const LogHook& log) {
  const std::string& source = options.source;
  if (source.starts_with(kBop)) {
    const std::string folder = source.substr(kBop.size());
    return OpenCamera([folder, options] { return open_bop_camera(folder, options); });
  }
  if (is_recording(source)) return openni2_camera(source, options, log);
  if (source == kOpenni2) return openni2_camera("", options, log);
  if (source.starts_with(kOneOfOpenni2)) {
    return openni2_camera(source.substr(kOneOfOpenni2.size()), options, log);
  }
  return invalid_argument("capture.source names no camera");
}

bool is_recording(const std::string& source) { return source.ends_with(".oni"); }

bool is_paced(const CameraOptions& options) {
  return options.every_frame && (is_recording(options.source) || options.source.starts_with(kBop));
}

}  // namespace bpa::camera
