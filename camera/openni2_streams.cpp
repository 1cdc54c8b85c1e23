// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/openni2_streams.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <openni2/PS1080.h>

#include "camera/openni2_library.hpp"
#include "camera/video_mode.hpp"
#include "core/io/camera_file.hpp"

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
void copy_rows(const openni::VideoFrameRef& frame, bool mirror, void* to) {
  const std::size_t bytes = pixel_bytes(frame.getVideoMode().getPixelFormat());
  const auto width = static_cast<std::size_t>(frame.getWidth());
  const auto* from = static_cast<const std::uint8_t*>(frame.getData());
  auto* out = static_cast<std::uint8_t*>(to);
  for (int v = 0; v < frame.getHeight(); ++v) {
    if (!mirror) {
      std::memcpy(out, from, width * bytes);
    } else {
      for (std::size_t u = 0; u < width; ++u) {
        std::memcpy(out + u * bytes, from + (width - 1 - u) * bytes, bytes);
      }
    }
    from += frame.getStrideInBytes();
    out += width * bytes;
  }
}

Status fit(const std::string& path, const openni::VideoMode& mode, Intrinsics& intrinsics) {
  Camera& camera = intrinsics.camera;
  const double scale = static_cast<double>(mode.getResolutionX()) / camera.width;
  if (mode.getResolutionY() != std::lround(camera.height * scale)) {
    return invalid_argument(path + " is for " + std::to_string(camera.width) + "x" +
                            std::to_string(camera.height) + "; images of " +
                            to_string(plain(mode)) + " have another shape");
  }
  camera.width = mode.getResolutionX();
  camera.height = mode.getResolutionY();
  camera.fx *= scale;
  camera.fy *= scale;
  camera.cx = (camera.cx + 0.5) * scale - 0.5;
  camera.cy = (camera.cy + 0.5) * scale - 0.5;
  return {};
}

}  // namespace

bool readable(openni::PixelFormat format) {
  return std::find(std::begin(kFormats), std::end(kFormats), format) != std::end(kFormats);
}

Status choose_mode(openni::VideoStream& stream, const openni::SensorInfo& sensor,
                   const std::string& field, const std::string& wanted) {
  const auto mode = parse_video_mode(wanted);
  if (!mode) return invalid_argument(field + " is \"" + wanted + "\"; it must read 640x480@30");
  const auto& modes = sensor.getSupportedVideoModes();
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
      return Status(StatusCode::unavailable,
                    "the device refuses its mode " + wanted + ": " + openni2_error());
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

Result<Intrinsics> intrinsics_of(openni::VideoStream& stream, const std::string& path,
                                 const std::string& what) {
  const openni::VideoMode mode = stream.getVideoMode();
  Intrinsics intrinsics;
  Camera& camera = intrinsics.camera;
  if (!path.empty()) {
    const auto file = io::read_camera(path);
    if (!file.ok()) return file.status();
    intrinsics.camera = file->camera;
    intrinsics.distortion = file->distortion;
    if (camera.width <= 0) return invalid_argument(path + " does not say the size of its images");
    if (Status status = fit(path, mode, intrinsics); !status.ok()) return status;
    return intrinsics;
  }
  const double horizontal = stream.getHorizontalFieldOfView();
  const double vertical = stream.getVerticalFieldOfView();
  if (!(horizontal > 0.1 && horizontal < 3 && vertical > 0.1 && vertical < 3)) {
    return invalid_argument("the device does not say the field of view of its " + what +
                            "; give a calibration file (capture.calibration)");
  }
  camera.width = mode.getResolutionX();
  camera.height = mode.getResolutionY();
  camera.fx = camera.width / (2 * std::tan(horizontal / 2));
  camera.fy = camera.height / (2 * std::tan(vertical / 2));
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
  return intrinsics;
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

std::vector<std::uint16_t> depth_pixels(const openni::VideoFrameRef& frame,
                                        const StreamFormat& format) {
  std::vector<std::uint16_t> pixels(static_cast<std::size_t>(frame.getWidth()) *
                                    static_cast<std::size_t>(frame.getHeight()));
  copy_rows(frame, format.mirrored, pixels.data());
  if (format.max_value <= 0) return pixels;
  for (std::uint16_t& z : pixels) {
    if (z > format.max_value) z = 0;
  }
  return pixels;
}

std::vector<std::uint8_t> pixel_bytes_of(const openni::VideoFrameRef& frame, bool mirror) {
  std::vector<std::uint8_t> bytes(pixel_bytes(frame.getVideoMode().getPixelFormat()) *
                                  static_cast<std::size_t>(frame.getWidth()) *
                                  static_cast<std::size_t>(frame.getHeight()));
  copy_rows(frame, mirror, bytes.data());
  return bytes;
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

Status record_frame(OniWriter& writer, std::size_t index, const openni::VideoFrameRef& frame) {
  const std::vector<std::uint8_t> bytes = pixel_bytes_of(frame, false);
  return writer.add(index, static_cast<std::int64_t>(frame.getTimestamp()), bytes.data(),
                    bytes.size());
}

}  // namespace bpa::camera
