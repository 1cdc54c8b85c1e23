// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/openni2_sim/sim_device.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace bpa::sim_driver {

SimDevice::SimDevice(SimFrames frames, const SimConfig& config)
    : frames_(std::move(frames)),
      config_(config),
      modes_{modes_of(ONI_SENSOR_DEPTH, frames_.depth, config.fine_depth),
             modes_of(ONI_SENSOR_COLOR, frames_.color, config.fine_depth)} {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    sensors_[i].sensorType = i == 0 ? ONI_SENSOR_DEPTH : ONI_SENSOR_COLOR;
    sensors_[i].numSupportedVideoModes = static_cast<int>(modes_[i].size());
    sensors_[i].pSupportedVideoModes = modes_[i].data();
  }
  thread_ = std::thread([this] { run(); });
}

SimDevice::~SimDevice() {
  stopping_ = true;
  thread_.join();
}

OniStatus SimDevice::getSensorInfoList(OniSensorInfo** sensors, int* count) {
  config_.pass();
  *sensors = sensors_.data();
  *count = config_.color_sensor ? 2 : 1;
  return ONI_STATUS_OK;
}

oni::driver::StreamBase* SimDevice::createStream(OniSensorType sensor) {
  config_.pass();
  if (sensor != ONI_SENSOR_DEPTH && !(sensor == ONI_SENSOR_COLOR && config_.color_sensor)) {
    return nullptr;
  }
  auto* stream = new SimStream(sensor, frames_, config_, registering_);
  const std::lock_guard<std::mutex> lock(mutex_);
  streams_.push_back(stream);
  return stream;
}

void SimDevice::destroyStream(oni::driver::StreamBase* stream) {
  config_.pass();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    streams_.erase(std::remove(streams_.begin(), streams_.end(), stream), streams_.end());
  }
  delete stream;
}

OniStatus SimDevice::setProperty(int id, const void* data, int size) {
  config_.pass();
  if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_SUPPORTED;
  OniImageRegistrationMode mode{};
  if (size != static_cast<int>(sizeof mode)) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(&mode, data, sizeof mode);
  if (isImageRegistrationModeSupported(mode) == FALSE) return ONI_STATUS_NOT_SUPPORTED;
  registering_ = mode == ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR;
  return ONI_STATUS_OK;
}

OniStatus SimDevice::getProperty(int id, void* data, int* size) {
  config_.pass();
  if (id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) {
    const OniImageRegistrationMode mode =
        registering_ ? ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR : ONI_IMAGE_REGISTRATION_OFF;
    if (*size != static_cast<int>(sizeof mode)) return ONI_STATUS_BAD_PARAMETER;
    std::memcpy(data, &mode, sizeof mode);
    return ONI_STATUS_OK;
  }
  if (id == ONI_DEVICE_PROPERTY_DRIVER_VERSION && *size == static_cast<int>(sizeof(OniVersion))) {
    const OniVersion version{1, 0, 0, 0};
    std::memcpy(data, &version, sizeof version);
    return ONI_STATUS_OK;
  }
  return ONI_STATUS_NOT_SUPPORTED;
}

OniBool SimDevice::isPropertySupported(int id) {
  return id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || id == ONI_DEVICE_PROPERTY_DRIVER_VERSION
             ? TRUE
             : FALSE;
}

OniBool SimDevice::isImageRegistrationModeSupported(OniImageRegistrationMode mode) {
  config_.pass();
  return mode == ONI_IMAGE_REGISTRATION_OFF || config_.registration != Registration::none ? TRUE
                                                                                          : FALSE;
}

OniStatus SimDevice::tryManualTrigger() {
  config_.pass();
  return ONI_STATUS_OK;
}

void SimDevice::run() {
  const auto start = std::chrono::steady_clock::now();
  for (std::uint64_t tick = 0; !stopping_; ++tick) {
    const auto since_start = std::chrono::microseconds(tick * 1'000'000 / 30);
    std::this_thread::sleep_until(start + since_start);
    if (!config_.deliver || config_.wedged || !config_.plugged) continue;
    const std::lock_guard<std::mutex> lock(mutex_);
    // Depth first, as most devices do; the device's clock started before.
    const auto stamp = static_cast<std::uint64_t>(since_start.count()) + 5'000'000;
    for (SimStream* stream : streams_) stream->show(tick, stamp);
  }
}

}  // namespace bpa::sim_driver
