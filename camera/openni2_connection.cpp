// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <thread>

#include "camera/open_camera.hpp"
#include "camera/openni2.hpp"
#include "core/base/concat.hpp"

namespace bpa::camera {
namespace {

constexpr float kManualSpeed = -1;  // OpenNI2: a frame comes only when it is waited for

}  // namespace

Result<std::unique_ptr<Openni2Connection>> Openni2Connection::open(std::shared_ptr<void> library,
                                                                   const std::string& uri,
                                                                   const CameraOptions& options,
                                                                   LogHook hook) {
  std::unique_ptr<Openni2Connection> self(
      new Openni2Connection(std::move(library), uri, options, std::move(hook)));
  if (Status s = self->bring_up(); !s.ok()) return s;
  return self;
}

Status Openni2Connection::bring_up() {
  if (Status s = connect(); !s.ok()) return s;
  if (Status s = open_depth(); !s.ok()) return s;
  if (Status s = open_color(); !s.ok()) return s;
  if (Status s = measure_cameras(); !s.ok()) return s;
  if (Status s = start_playback(); !s.ok()) return s;
  if (depth.start() != openni::STATUS_OK) return failed(" does not start its depth stream");
  if (!with_color()) return {};
  if (color.start() != openni::STATUS_OK) return failed(" does not start its colour stream");
  if (Status s = choose_registrar(); !s.ok()) return s;
  if (file) return {};
  const char* who = set_in_step(true) ? "the device" : "the server";
  log(log_, LogLevel::debug, std::string("capture: depth and colour are put in step by ") + who);
  return {};
}

Status Openni2Connection::failed(const std::string& what) const {
  return unavailable(name, what, ": ", openni2_error());
}

Status Openni2Connection::connect() {
  if (is_recording(uri_)) {
    auto info = inspect_oni_file(uri_);
    if (!info.ok()) return info.status();
    if (uri_.size() >= ONI_MAX_STR) {
      return invalid_argument(uri_ + " is too long a path for OpenNI2, which takes 255 characters");
    }
    file = std::move(info).value();
  } else if (uri_.empty()) {
    openni::Array<openni::DeviceInfo> found;
    openni::OpenNI::enumerateDevices(&found);
    if (found.getSize() == 0) {
      return unavailable("no OpenNI2 sensor is connected");
    }
    uri_ = found[0].getUri();
  }
  openni::OpenNI::addDeviceDisconnectedListener(this);
  openni::OpenNI::addDeviceStateChangedListener(this);
  if (device.open(uri_.c_str()) != openni::STATUS_OK) {
    return failed("the OpenNI2 sensor " + uri_ + " is not there or cannot be opened");
  }
  name = file ? "the recording " + uri_
              : std::string(device.getDeviceInfo().getName()) + " (" + uri_ + ")";
  if (!file) device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_OFF);
  return {};
}

Openni2Connection::~Openni2Connection() {
  openni::OpenNI::removeDeviceDisconnectedListener(this);
  openni::OpenNI::removeDeviceStateChangedListener(this);
  if (in_step) device.setDepthColorSyncEnabled(false);  // while its streams are still there
  if (depth.isValid()) depth.stop();
  if (color.isValid()) color.stop();
  // Some drivers (Debian's DummyDevice) go on with the frame that they are making after stop().
  if (depth.isValid()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  depth.destroy();
  color.destroy();
  device.close();
}

Status Openni2Connection::open_depth() {
  if (device.getSensorInfo(openni::SENSOR_DEPTH) == nullptr) {
    return invalid_argument(name + " has no depth sensor");
  }
  if (depth.create(device, openni::SENSOR_DEPTH) != openni::STATUS_OK) {
    return failed(" gives no depth");
  }
  if (!file) {
    if (Status s = choose_mode(depth, "capture.depth_mode", options_.depth_mode); !s.ok()) return s;
  }
  const openni::PixelFormat format = depth.getVideoMode().getPixelFormat();
  if (!readable(format)) {
    return Status(StatusCode::unsupported, concat(name, " gives depth in the format ", format,
                                                  "; it must be in 1 mm (100) or 0.1 mm (101)"));
  }
  depth_mirrored = still_mirrored(depth);
  max_depth = depth.getMaxPixelValue();
  return {};
}

/// Makes the colour stream if it is wanted; `complaint` says why there is none that can be read.
Status Openni2Connection::open_color() {
  if (!options_.color) return {};
  if (device.getSensorInfo(openni::SENSOR_COLOR) == nullptr) {
    complaint = "it has no colour camera, so there is depth alone";
    return {};
  }
  if (color.create(device, openni::SENSOR_COLOR) != openni::STATUS_OK) {
    return failed(" gives no colour");
  }
  if (!file) {
    if (Status s = choose_mode(color, "capture.color_mode", options_.color_mode); !s.ok()) return s;
  }
  if (!readable(color.getVideoMode().getPixelFormat())) {
    color.destroy();
    complaint = "its colour is neither rgb nor grey, so there is depth alone";
    return {};
  }
  color_mirrored = still_mirrored(color);
  if (!file) set_exposure(color, options_, log_);
  return {};
}

/// Fills in the geometry of the cameras; while registration is off, since OpenNI2 then tells the
/// intrinsics of the depth camera.
Status Openni2Connection::measure_cameras() {
  const auto of_depth = intrinsics_of(depth, options_.depth_calibration, "depth camera");
  const auto of_color =
      with_color() ? intrinsics_of(color, options_.calibration, "colour camera") : of_depth;
  if (!of_color.ok()) return of_color.status();
  geometry.color = of_color->camera;
  const auto distortion = io::plumb_bob_of(*of_color);
  if (!distortion.ok()) return distortion.status();
  geometry.color_distortion = *distortion;
  // Needed only when the server registers; a device may not say its depth camera's field of view.
  geometry.depth = of_depth.ok() ? of_depth->camera : of_color->camera;
  const auto format = depth.getVideoMode().getPixelFormat();
  geometry.depth_unit = format == openni::PIXEL_FORMAT_DEPTH_1_MM ? 1e-3 : 1e-4;
  const double told = baseline_of(depth);
  geometry.baseline = told > 0 ? told : options_.baseline_mm / 1000;
  return {};
}

Status Openni2Connection::start_playback() {
  if (!file) return {};
  const OniStreamInfo* stream = file->find(OniStreamInfo::Kind::depth);
  const int count = stream != nullptr ? static_cast<int>(stream->frames) : 0;
  if (options_.start_frame > 1 && options_.start_frame > count) {
    return invalid_argument("capture.start_frame is ", options_.start_frame, "; ", name, " has ",
                            count, " frames");
  }
  openni::PlaybackControl* playback = device.getPlaybackControl();
  if (playback == nullptr) return failed(" cannot be played");
  playback->setRepeatEnabled(options_.loop);
  const bool manual = options_.every_frame || options_.start_frame > 1;
  playback->setSpeed(manual ? kManualSpeed : static_cast<float>(options_.speed));
  return {};
}

/// The depth image after skipping `frames` others; empty when none comes within half of
/// capture.timeout_ms, so that a sensor without frames does not look like a driver that hangs.
std::vector<std::uint16_t> Openni2Connection::depth_after(int frames) {
  openni::VideoFrameRef frame;
  openni::VideoStream* streams[] = {&depth};
  for (int i = 0; i <= frames; ++i) {
    int ready = 0;
    const auto waited = openni::OpenNI::waitForAnyStream(streams, 1, &ready,
                                                         static_cast<int>(options_.timeout_ms / 2));
    if (waited != openni::STATUS_OK || depth.readFrame(&frame) != openni::STATUS_OK) return {};
  }
  return depth_pixels(frame, depth_mirrored, max_depth);
}

/// Compares depth from before and after the device is asked to register; three times at most.
Result<Alignment> Openni2Connection::ask_device_to_register() {
  constexpr int kTries = 3;
  const auto mode = openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
  const Status silent(StatusCode::unavailable, name + " delivers no depth frames");
  if (!device.isImageRegistrationModeSupported(mode)) return Alignment::not_registered;
  Alignment alignment = Alignment::cannot_tell;
  for (int i = 0; i < kTries && alignment == Alignment::cannot_tell; ++i) {
    device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_OFF);
    const auto before = depth_after(i > 0 ? 2 : 0);
    if (before.empty()) return silent;
    if (device.setImageRegistrationMode(mode) != openni::STATUS_OK ||
        device.getImageRegistrationMode() != mode) {
      return Alignment::not_registered;
    }
    const auto after = depth_after(2);
    if (after.empty()) return silent;
    alignment = judge_registration(before, after, geometry);
  }
  return alignment;
}

/// Who registers depth, as capture.registration wants it and the device can.
Status Openni2Connection::choose_registrar() {
  const std::string& who = options_.registration;
  if (who == "off") return {};
  if (file) {  // its device did, unless the file says otherwise
    const bool unregistered = file->registered == OniFileInfo::Registered::no;
    registrar = unregistered || who == "software" ? Registrar::server : Registrar::device;
    return {};
  }
  if (who != "software") {
    const auto alignment = ask_device_to_register();
    if (!alignment.ok()) return alignment.status();
    if (*alignment == Alignment::cannot_tell) {
      log(log_, LogLevel::info,
          "capture: nothing in view shows whether " + name +
              " registers depth to colour, as it says");
    }
    registrar = Registrar::device;
    if (*alignment != Alignment::not_registered) return {};
  }
  if (who == "device") {
    return Status(StatusCode::unsupported, name + " does not register depth to colour; set " +
                                               "capture.registration to auto or software");
  }
  registrar = Registrar::server;
  device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_OFF);
  (void)depth_after(2);  // these may still be registered
  if (who == "auto") {
    log(log_, LogLevel::info,
        "capture: " + name + " does not register depth to colour; the server does it");
  }
  return {};
}

bool Openni2Connection::set_in_step(bool wanted) {
  const bool done = device.setDepthColorSyncEnabled(wanted) == openni::STATUS_OK;
  in_step = wanted && done;
  return done;
}

}  // namespace bpa::camera
