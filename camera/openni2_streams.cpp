// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>

#include <openni2/PS1080.h>

#include "camera/openni2.hpp"
#include "core/base/concat.hpp"

namespace bpa::camera {
namespace {

/// The formats we read, the best first.
constexpr openni::PixelFormat kFormats[] = {
    openni::PIXEL_FORMAT_DEPTH_1_MM, openni::PIXEL_FORMAT_DEPTH_100_UM, openni::PIXEL_FORMAT_RGB888,
    openni::PIXEL_FORMAT_GRAY8};

std::size_t pixel_bytes(openni::PixelFormat format) {
  if (format == openni::PIXEL_FORMAT_RGB888) return 3;
  return format == openni::PIXEL_FORMAT_GRAY8 ? 1 : 2;
}

VideoMode plain(const openni::VideoMode& mode) {
  return {mode.getResolutionX(), mode.getResolutionY(), mode.getFps()};
}

/// The rows of a frame without padding, its pixels in reverse order in each if `mirror`.
template <class Value>
std::vector<Value> rows_of(const openni::VideoFrameRef& frame, bool mirror) {
  const std::size_t bytes = pixel_bytes(frame.getVideoMode().getPixelFormat());
  const std::size_t row = bytes * static_cast<std::size_t>(frame.getWidth());
  std::vector<Value> values(row * static_cast<std::size_t>(frame.getHeight()) / sizeof(Value));
  const auto* from = static_cast<const std::uint8_t*>(frame.getData());
  auto* to = reinterpret_cast<std::uint8_t*>(values.data());
  for (int v = 0; v < frame.getHeight(); ++v, from += frame.getStrideInBytes(), to += row) {
    if (!mirror) {
      std::memcpy(to, from, row);
      continue;
    }
    for (std::size_t u = 0; u < row; u += bytes) std::memcpy(to + u, from + row - bytes - u, bytes);
  }
  return values;
}

}  // namespace

Result<std::shared_ptr<void>> load_openni2() {
  const std::shared_ptr<void> library(nullptr, [](void*) { openni::OpenNI::shutdown(); });
  if (openni::OpenNI::initialize() == openni::STATUS_OK) return library;
  return unavailable("OpenNI2 cannot start: ", openni2_error());
}

std::string openni2_error() {
  std::string text;
  for (const char* c = openni::OpenNI::getExtendedError(); *c != '\0'; ++c) {
    const bool space = *c == '\n' || *c == '\t' || *c == '\r';
    if (!space) {
      text += *c;
    } else if (!text.empty() && text.back() != ' ') {
      text += c[1] != '\0' ? "; " : "";
    }
  }
  while (!text.empty() && (text.back() == ' ' || text.back() == ';')) text.pop_back();
  return text.empty() ? "OpenNI2 does not say why" : text;
}

bool readable(openni::PixelFormat format) {
  return std::ranges::find(kFormats, format) != std::end(kFormats);
}

Status choose_mode(openni::VideoStream& stream, const std::string& field,
                   const std::string& wanted) {
  const auto mode = parse_video_mode(wanted);
  if (!mode) return invalid_argument(field + " is \"" + wanted + "\"; it must read 640x480@30");
  const auto& modes = stream.getSensorInfo().getSupportedVideoModes();
  std::vector<VideoMode> known;
  for (const openni::PixelFormat format : kFormats) {
    for (int i = 0; i < modes.getSize(); ++i) {
      if (modes[i].getPixelFormat() != format) continue;
      known.push_back(plain(modes[i]));
      if (!(known.back() == *mode)) continue;
      const openni::VideoMode now = stream.getVideoMode();
      const bool is_set = plain(now) == *mode && now.getPixelFormat() == format;
      // Drivers of one mode (Debian's DummyDevice) refuse to set even that.
      if (is_set || stream.setVideoMode(modes[i]) == openni::STATUS_OK) return {};
      return unavailable("the device refuses its mode ", wanted, ": ", openni2_error());
    }
  }
  return invalid_argument(field + " is " + wanted + "; the device has " + list_of(known));
}

bool still_mirrored(openni::VideoStream& stream) {
  if (!stream.getMirroringEnabled()) return false;
  stream.setMirroringEnabled(false);
  return stream.getMirroringEnabled();
}

void set_exposure(openni::VideoStream& color, const CameraOptions& options, const LogHook& hook) {
  openni::CameraSettings* settings = color.getCameraSettings();
  const bool usual = options.auto_exposure && options.auto_white_balance;
  if (settings == nullptr || !settings->isValid()) {
    if (!usual) log(hook, LogLevel::warning, "capture: the device has no exposure settings");
    return;
  }
  const auto check = [&](openni::Status status, const char* what) {
    if (status == openni::STATUS_OK) return;
    log(hook, usual ? LogLevel::debug : LogLevel::warning,
        std::string("capture: the device does not let set its ") + what);
  };
  check(settings->setAutoExposureEnabled(options.auto_exposure), "automatic exposure");
  check(settings->setAutoWhiteBalanceEnabled(options.auto_white_balance),
        "automatic white balance");
  if (options.auto_exposure) return;
  if (options.exposure > 0) check(settings->setExposure(options.exposure), "exposure");
  if (options.gain > 0) check(settings->setGain(options.gain), "gain");
}

Result<io::CameraFile> intrinsics_of(openni::VideoStream& stream, const std::string& path,
                                     const std::string& what) {
  const VideoMode mode = plain(stream.getVideoMode());
  if (path.empty()) {
    const double horizontal = stream.getHorizontalFieldOfView();
    const double vertical = stream.getVerticalFieldOfView();
    if (!(horizontal > 0.1 && horizontal < 3 && vertical > 0.1 && vertical < 3)) {
      return invalid_argument("the device does not say the field of view of its " + what +
                              "; give a calibration file (capture.calibration)");
    }
    const double fx = mode.width / (2 * std::tan(horizontal / 2));
    const double fy = mode.height / (2 * std::tan(vertical / 2));
    io::CameraFile told;
    told.camera = {
        mode.width, mode.height, fx, fy, (mode.width - 1) / 2.0, (mode.height - 1) / 2.0};
    return told;
  }
  auto file = io::read_camera(path);
  if (!file.ok()) return file.status();
  Camera& c = file->camera;
  if (c.width <= 0) return invalid_argument(path + " does not say the size of its images");
  const double scale = static_cast<double>(mode.width) / c.width;
  if (mode.height != std::lround(c.height * scale)) {
    return invalid_argument(path, " is for ", c.width, "x", c.height, "; images of ",
                            to_string(mode), " have another shape");
  }
  const double cx = (c.cx + 0.5) * scale - 0.5, cy = (c.cy + 0.5) * scale - 0.5;
  c = {mode.width, mode.height, c.fx * scale, c.fy * scale, cx, cy};
  return file;
}

double baseline_of(openni::VideoStream& depth) {
  double centimetres = 0;
  int size = sizeof centimetres;
  const openni::Status status =
      depth.getProperty(XN_STREAM_PROPERTY_DCMOS_RCMOS_DISTANCE, &centimetres, &size);
  const bool usable = status == openni::STATUS_OK && size == static_cast<int>(sizeof centimetres) &&
                      centimetres > 0 && centimetres < 20;
  return usable ? centimetres / 100 : 0;
}

std::vector<std::uint16_t> depth_pixels(const openni::VideoFrameRef& frame, bool mirror,
                                        int max_value) {
  std::vector<std::uint16_t> pixels = rows_of<std::uint16_t>(frame, mirror);
  if (max_value > 0)
    std::ranges::replace_if(
        pixels, [=](int z) { return z > max_value; }, 0);
  return pixels;
}

std::vector<std::uint8_t> pixel_bytes_of(const openni::VideoFrameRef& frame, bool mirror) {
  return rows_of<std::uint8_t>(frame, mirror);
}

OniStreamFormat recorded_format(openni::VideoStream& stream, OniStreamInfo::Kind kind) {
  const openni::VideoMode mode = stream.getVideoMode();
  OniStreamFormat format;
  format.kind = kind;
  format.width = static_cast<std::uint32_t>(mode.getResolutionX());
  format.height = static_cast<std::uint32_t>(mode.getResolutionY());
  format.fps = static_cast<std::uint32_t>(mode.getFps());
  format.pixel_format = static_cast<std::uint32_t>(mode.getPixelFormat());
  format.frame_bytes =
      static_cast<std::uint32_t>(pixel_bytes(mode.getPixelFormat())) * format.width * format.height;
  format.horizontal_fov = stream.getHorizontalFieldOfView();
  format.vertical_fov = stream.getVerticalFieldOfView();
  format.mirrored = stream.getMirroringEnabled();
  if (kind == OniStreamInfo::Kind::depth) {
    format.max_depth = static_cast<std::uint32_t>(std::max(0, stream.getMaxPixelValue()));
    format.baseline_cm = 100 * baseline_of(stream);
  }
  return format;
}

}  // namespace bpa::camera
