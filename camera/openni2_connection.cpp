// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/openni2_connection.hpp"

#include <chrono>
#include <thread>
#include <utility>

namespace bpa::camera {
namespace {

Status not_there(const std::string& uri) {
  if (uri.empty()) return Status(StatusCode::unavailable, "no OpenNI2 sensor is connected");
  return Status(
      StatusCode::unavailable,
      "the OpenNI2 sensor " + uri + " is not there or cannot be opened: " + openni2_error());
}

/// The URI of the first device that OpenNI2 lists; empty when there is none.
std::string first_device() {
  openni::Array<openni::DeviceInfo> found;
  openni::OpenNI::enumerateDevices(&found);
  return found.getSize() > 0 ? found[0].getUri() : "";
}

}  // namespace

Result<std::unique_ptr<Openni2Connection>> Openni2Connection::open(
    std::shared_ptr<Openni2Library> library, const Openni2Target& target) {
  std::unique_ptr<Openni2Connection> self(new Openni2Connection(std::move(library)));
  if (Status status = self->connect(target); !status.ok()) return status;
  return self;
}

Status Openni2Connection::connect(const Openni2Target& target) {
  uri_ = target.uri;
  is_recording_ = target.file;
  if (is_recording_) {
    auto info = inspect_oni_file(uri_);
    if (!info.ok()) return info.status();
    if (uri_.size() >= ONI_MAX_STR) {
      return invalid_argument(uri_ + " is too long a path for OpenNI2, which takes 255 characters");
    }
    file_ = std::move(info).value();
  } else if (uri_.empty()) {
    uri_ = first_device();
    if (uri_.empty()) return not_there(uri_);
  }
  openni::OpenNI::addDeviceDisconnectedListener(this);
  openni::OpenNI::addDeviceStateChangedListener(this);
  if (device.open(uri_.c_str()) != openni::STATUS_OK) return not_there(uri_);
  name_ = is_recording_ ? "the recording " + uri_
                        : std::string(device.getDeviceInfo().getName()) + " (" + uri_ + ")";
  if (!is_recording_) device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_OFF);
  return {};
}

Openni2Connection::~Openni2Connection() {
  openni::OpenNI::removeDeviceDisconnectedListener(this);
  openni::OpenNI::removeDeviceStateChangedListener(this);
  if (in_step_) device.setDepthColorSyncEnabled(false);  // while its streams are still there
  if (depth.isValid()) depth.stop();
  if (color.isValid()) color.stop();
  // Some drivers (Debian's DummyDevice) go on with the frame that they are making after stop().
  if (depth.isValid()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  depth.destroy();
  color.destroy();
  device.close();
}

bool Openni2Connection::set_in_step(bool in_step) {
  const bool done = device.setDepthColorSyncEnabled(in_step) == openni::STATUS_OK;
  in_step_ = in_step && done;
  return done;
}

void Openni2Connection::onDeviceDisconnected(const openni::DeviceInfo* info) {
  if (uri_ == info->getUri()) gone_ = true;
}

void Openni2Connection::onDeviceStateChanged(const openni::DeviceInfo* info,
                                             openni::DeviceState state) {
  if (uri_ == info->getUri() && state == openni::DEVICE_STATE_EOF) ended_ = true;
}

}  // namespace bpa::camera
