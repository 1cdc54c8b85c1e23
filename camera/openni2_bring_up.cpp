// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/openni2_bring_up.hpp"

#include <utility>
#include <vector>

namespace bpa::camera {
namespace {

constexpr float kManualSpeed = -1;  // OpenNI2: a frame comes only when it is waited for

Status failed(const std::string& what) {
  return Status(StatusCode::unavailable, what + ": " + openni2_error());
}

Result<StreamFormat> open_depth(Openni2Connection& c, const CameraOptions& options) {
  const openni::SensorInfo* sensor = c.device.getSensorInfo(openni::SENSOR_DEPTH);
  if (sensor == nullptr) return invalid_argument(c.name() + " has no depth sensor");
  if (c.depth.create(c.device, openni::SENSOR_DEPTH) != openni::STATUS_OK) {
    return failed(c.name() + " gives no depth");
  }
  if (!c.is_recording()) {
    const Status s = choose_mode(c.depth, *sensor, "capture.depth_mode", options.depth_mode);
    if (!s.ok()) return s;
  }
  const openni::PixelFormat format = c.depth.getVideoMode().getPixelFormat();
  if (!readable(format)) {
    return Status(StatusCode::unsupported, c.name() + " gives depth in the format " +
                                               std::to_string(format) +
                                               "; it must be in 1 mm (100) or 0.1 mm (101)");
  }
  return StreamFormat{still_mirrored(c.depth), c.depth.getMaxPixelValue()};
}

/// Makes the colour stream, unless none is wanted or there is none that can be read: then
/// `complaint` says why.
Result<StreamFormat> open_color(Openni2Connection& c, const CameraOptions& options,
                                const LogHook& hook, std::string& complaint) {
  if (!options.color) return StreamFormat{};
  const openni::SensorInfo* sensor = c.device.getSensorInfo(openni::SENSOR_COLOR);
  if (sensor == nullptr) {
    complaint = "it has no colour camera, so there is depth alone";
    return StreamFormat{};
  }
  if (c.color.create(c.device, openni::SENSOR_COLOR) != openni::STATUS_OK) {
    return failed(c.name() + " gives no colour");
  }
  if (!c.is_recording()) {
    const Status s = choose_mode(c.color, *sensor, "capture.color_mode", options.color_mode);
    if (!s.ok()) return s;
  }
  if (!readable(c.color.getVideoMode().getPixelFormat())) {
    c.color.destroy();
    complaint = "its colour is neither rgb nor grey, so there is depth alone";
    return StreamFormat{};
  }
  const StreamFormat format{still_mirrored(c.color), 0};
  if (!c.is_recording()) set_exposure(c.color, options, hook);
  return format;
}

/// Fills in the geometry of the cameras and the intrinsics of the images; while registration is
/// off, since OpenNI2 then tells those of the depth camera.
Status measure_cameras(Openni2Connection& c, const CameraOptions& options, Openni2Setup& setup) {
  const auto depth = intrinsics_of(c.depth, options.depth_calibration, "depth camera");
  const auto color =
      c.with_color() ? intrinsics_of(c.color, options.calibration, "colour camera") : depth;
  if (!color.ok()) return color.status();
  setup.output = *color;
  DeviceGeometry& geometry = setup.geometry;
  const bool millimetres =
      c.depth.getVideoMode().getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_1_MM;
  geometry.depth_unit = millimetres ? 1e-3 : 1e-4;
  geometry.color = color->camera;
  // Needed only when the server registers; a device may not say its depth camera's field of view.
  geometry.depth = depth.ok() ? depth->camera : color->camera;
  if (!c.with_color()) return {};
  geometry.color_distortion = color->distortion;
  const double told = baseline_of(c.depth);
  geometry.baseline = told > 0 ? told : options.baseline_mm / 1000;
  return {};
}

Status start_playback(Openni2Connection& c, const CameraOptions& options) {
  const OniStreamInfo* stream = c.file().find(OniStreamInfo::Kind::depth);
  const int count = stream != nullptr ? static_cast<int>(stream->frames) : 0;
  if (options.start_frame > 1 && options.start_frame > count) {
    return invalid_argument("capture.start_frame is " + std::to_string(options.start_frame) + "; " +
                            c.name() + " has " + std::to_string(count) + " frames");
  }
  openni::PlaybackControl* playback = c.device.getPlaybackControl();
  if (playback == nullptr) return failed(c.name() + " cannot be played");
  playback->setRepeatEnabled(options.loop);
  const bool manual = options.every_frame || options.start_frame > 1;
  playback->setSpeed(manual ? kManualSpeed : static_cast<float>(options.speed));
  return {};
}

Status start_streams(Openni2Connection& c) {
  if (c.depth.start() != openni::STATUS_OK) {
    return failed(c.name() + " does not start its depth stream");
  }
  if (c.with_color() && c.color.start() != openni::STATUS_OK) {
    return failed(c.name() + " does not start its colour stream");
  }
  return {};
}

/// The depth image after skipping `frames` others; empty when none comes within half of
/// `timeout_ms`, so that a sensor without frames does not look like a driver that hangs.
std::vector<std::uint16_t> depth_after(int frames, Openni2Connection& c, const StreamFormat& format,
                                       double timeout_ms) {
  openni::VideoFrameRef frame;
  openni::VideoStream* streams[] = {&c.depth};
  for (int i = 0; i <= frames; ++i) {
    int ready = 0;
    const auto waited =
        openni::OpenNI::waitForAnyStream(streams, 1, &ready, static_cast<int>(timeout_ms / 2));
    if (waited != openni::STATUS_OK || c.depth.readFrame(&frame) != openni::STATUS_OK) return {};
  }
  return depth_pixels(frame, format);
}

/// Asks the device to register and compares its depth before and after; up to three times while the
/// view changes.
Result<Alignment> ask_device_to_register(Openni2Connection& c, const Openni2Setup& setup,
                                         double timeout_ms) {
  constexpr int kTries = 3;
  const auto mode = openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
  const Status silent(StatusCode::unavailable, c.name() + " delivers no depth frames");
  if (!c.device.isImageRegistrationModeSupported(mode)) return Alignment::not_registered;
  Alignment alignment = Alignment::cannot_tell;
  for (int i = 0; i < kTries && alignment == Alignment::cannot_tell; ++i) {
    c.device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_OFF);
    const auto before = depth_after(i > 0 ? 2 : 0, c, setup.depth, timeout_ms);
    if (before.empty()) return silent;
    if (c.device.setImageRegistrationMode(mode) != openni::STATUS_OK ||
        c.device.getImageRegistrationMode() != mode) {
      return Alignment::not_registered;
    }
    const auto after = depth_after(2, c, setup.depth, timeout_ms);
    if (after.empty()) return silent;
    alignment = judge_registration(before, after, setup.geometry);
  }
  return alignment;
}

/// Who registers a sensor's depth, as capture.registration wants it and the device can.
Result<Registrar> choose_registrar(Openni2Connection& c, const Openni2Setup& setup,
                                   const CameraOptions& options, const LogHook& hook) {
  const std::string& who = options.registration;
  if (who != "software") {
    const auto alignment = ask_device_to_register(c, setup, options.timeout_ms);
    if (!alignment.ok()) return alignment.status();
    if (*alignment == Alignment::cannot_tell) {
      log(hook, LogLevel::info,
          "capture: nothing in view shows whether " + c.name() +
              " registers depth to colour, as it says");
    }
    if (*alignment != Alignment::not_registered) return Registrar::device;
  }
  if (who == "device") {
    return Status(StatusCode::unsupported, c.name() + " does not register depth to colour; set " +
                                               "capture.registration to auto or software");
  }
  c.device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_OFF);
  (void)depth_after(2, c, setup.depth, options.timeout_ms);  // these may still be registered
  if (who == "auto") {
    log(hook, LogLevel::info,
        "capture: " + c.name() + " does not register depth to colour; the server does it");
  }
  return Registrar::server;
}

/// Who registers the depth of a recording: its device did, unless the file says otherwise.
Registrar registrar_of_recording(const OniFileInfo& file, const CameraOptions& options) {
  const bool unregistered = file.registered == OniFileInfo::Registered::no;
  return unregistered || options.registration == "software" ? Registrar::server : Registrar::device;
}

void put_in_step(Openni2Connection& c, const LogHook& hook) {
  const bool done = c.set_in_step(true);
  log(hook, LogLevel::debug,
      std::string("capture: depth and colour are put in step by ") +
          (done ? "the device" : "the server"));
}

}  // namespace

Result<Openni2Setup> bring_up(Openni2Connection& connection, const CameraOptions& options,
                              const LogHook& hook) {
  Openni2Setup setup;
  const auto depth = open_depth(connection, options);
  if (!depth.ok()) return depth.status();
  setup.depth = *depth;
  const auto color = open_color(connection, options, hook, setup.complaint);
  if (!color.ok()) return color.status();
  setup.color = *color;
  if (Status s = measure_cameras(connection, options, setup); !s.ok()) return s;
  if (connection.is_recording()) {
    if (Status s = start_playback(connection, options); !s.ok()) return s;
  }
  if (Status s = start_streams(connection); !s.ok()) return s;
  if (!connection.with_color()) return setup;
  if (connection.is_recording()) {
    if (options.registration != "off") {
      setup.registrar = registrar_of_recording(connection.file(), options);
    }
    return setup;
  }
  if (options.registration != "off") {
    const auto registrar = choose_registrar(connection, setup, options, hook);
    if (!registrar.ok()) return registrar.status();
    setup.registrar = *registrar;
  }
  put_in_step(connection, hook);
  return setup;
}

}  // namespace bpa::camera
