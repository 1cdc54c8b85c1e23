// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/open_camera.hpp"

#include <string_view>
#include <utility>

#include "camera/bop_camera.hpp"
#include "camera/openni2_device.hpp"
#include "camera/video_mode.hpp"

namespace bpa::camera {
namespace {

constexpr const char* kOpenni2 = "openni2";
constexpr const char* kBop = "bop:";

constexpr const char* kOneOfOpenni2 = "openni2:";

bool is_recording(const std::string& source) { return source.ends_with(".oni"); }

}  // namespace

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
    const std::string folder = source.substr(std::string_view(kBop).size());
    return OpenCamera([folder, options] { return open_bop_camera(folder, options); });
  }
  if (is_recording(source)) return openni2_camera({source, true}, options, log);
  if (source == kOpenni2) return openni2_camera({"", false}, options, log);
  if (source.starts_with(kOneOfOpenni2)) {
    const std::string uri = source.substr(std::string_view(kOneOfOpenni2).size());
    return openni2_camera({uri, false}, options, log);
  }
  return invalid_argument("capture.source names no camera");
}

bool is_paced(const CameraOptions& options) {
  return options.every_frame && (is_recording(options.source) || options.source.starts_with(kBop));
}

}  // namespace bpa::camera
