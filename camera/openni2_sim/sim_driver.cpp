// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "camera/openni2_sim/sim_stream.hpp"

namespace bpa::sim_driver {
namespace {

constexpr const char* kUri = "bpa-sim";

/// The opened device: two streams and the thread that shows them the frames at 30 Hz.
class SimDevice : public oni::driver::DeviceBase {
 public:
  SimDevice(SimFrames frames, const SimConfig& config)
      : frames_(std::move(frames)),
        config_(config),
        depth_modes_(modes_of(ONI_SENSOR_DEPTH, frames_.depth, config.fine_depth)),
        color_modes_(modes_of(ONI_SENSOR_COLOR, frames_.color, config.fine_depth)),
        thread_([this] { run(); }) {}
  ~SimDevice() override {
    stopping_ = true;
    thread_.join();
  }

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    config_.pass();
    *sensors = sensors_;
    *count = config_.color_sensor ? 2 : 1;
    return ONI_STATUS_OK;
  }

  oni::driver::StreamBase* createStream(OniSensorType sensor) override {
    config_.pass();
    const bool depth = sensor == ONI_SENSOR_DEPTH;
    if (!depth && !(sensor == ONI_SENSOR_COLOR && config_.color_sensor)) return nullptr;
    auto* stream =
        new SimStream(sensor, depth ? depth_modes_ : color_modes_, frames_, config_, registering_);
    const std::lock_guard<std::mutex> lock(mutex_);
    streams_.push_back(stream);
    return stream;
  }

  void destroyStream(oni::driver::StreamBase* stream) override {
    config_.pass();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      std::erase(streams_, stream);
    }
    delete stream;
  }

  OniStatus setProperty(int id, const void* data, int size) override {
    config_.pass();
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_SUPPORTED;
    OniImageRegistrationMode mode{};
    const OniStatus status = take(data, size, mode);
    if (status != ONI_STATUS_OK) return status;
    if (isImageRegistrationModeSupported(mode) == FALSE) return ONI_STATUS_NOT_SUPPORTED;
    registering_ = mode == ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR;
    return ONI_STATUS_OK;
  }

  OniStatus getProperty(int id, void* data, int* size) override {
    config_.pass();
    switch (id) {
      case ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION:
        return give(
            registering_ ? ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR : ONI_IMAGE_REGISTRATION_OFF, data,
            size);
      case ONI_DEVICE_PROPERTY_DRIVER_VERSION:
        return give(OniVersion{1, 0, 0, 0}, data, size);
      default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
  }

  OniBool isPropertySupported(int id) override {
    return id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || id == ONI_DEVICE_PROPERTY_DRIVER_VERSION;
  }

  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
    config_.pass();
    return mode == ONI_IMAGE_REGISTRATION_OFF || config_.can_register;
  }

  OniStatus tryManualTrigger() override {
    config_.pass();
    return ONI_STATUS_OK;
  }

 private:
  void run() {
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

  const SimFrames frames_;
  const SimConfig& config_;
  std::vector<OniVideoMode> depth_modes_;
  std::vector<OniVideoMode> color_modes_;
  OniSensorInfo sensors_[2] = {
      {ONI_SENSOR_DEPTH, static_cast<int>(depth_modes_.size()), depth_modes_.data()},
      {ONI_SENSOR_COLOR, static_cast<int>(color_modes_.size()), color_modes_.data()}};
  std::atomic<bool> registering_{false};
  std::mutex mutex_;  ///< Guards the list; held while frames are shown.
  std::vector<SimStream*> streams_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;  ///< Last: starts when all else is there.
};

/// Announces the device while it is plugged in, opens and closes it.
class SimDriver : public oni::driver::DriverBase {
 public:
  explicit SimDriver(OniDriverServices* services) : DriverBase(services) {}
  ~SimDriver() override { shutdown(); }

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback state_changed,
                       void* cookie) override {
    const OniStatus status = DriverBase::initialize(connected, disconnected, state_changed, cookie);
    if (status != ONI_STATUS_OK || config_.scenes.empty()) return status;
    follow();
    thread_ = std::thread([this] {
      while (!stopping_) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        config_.refresh();
        follow();
      }
    });
    return ONI_STATUS_OK;
  }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    config_.pass();
    if (std::string(uri) != kUri || !config_.plugged) return nullptr;
    auto frames = load_sim_frames(config_.scenes, config_.split);
    if (!frames.ok()) {
      getServices().errorLoggerAppend("%s", frames.status().message.c_str());
      return nullptr;
    }
    return new SimDevice(std::move(frames).value(), config_);
  }

  void deviceClose(oni::driver::DeviceBase* device) override {
    config_.pass();
    delete device;
  }

  /// Depth and colour of one tick have one number anyway, by which OpenNI2 puts them together.
  void* enableFrameSync(oni::driver::StreamBase**, int) override {
    config_.pass();
    return this;
  }
  void disableFrameSync(void*) override { config_.pass(); }

  void shutdown() override {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }

 private:
  /// Tells OpenNI2 when the device came or went.
  void follow() {
    if (announced_ == config_.plugged) return;
    announced_ = !announced_;
    OniDeviceInfo info{};
    std::snprintf(info.uri, sizeof info.uri, "%s", kUri);
    std::snprintf(info.vendor, sizeof info.vendor, "bpa");
    std::snprintf(info.name, sizeof info.name, "Simulated Kinect");
    if (announced_) {
      deviceConnected(&info);
    } else {
      deviceDisconnected(&info);
    }
  }

  SimConfig config_;
  bool announced_ = false;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace
}  // namespace bpa::sim_driver

// What the macro of OniDriverAPI.h takes from a header that Debian does not ship.
#define XN_NEW(type, argument) new type(argument)
#define XN_DELETE(pointer) delete pointer
#pragma GCC visibility push(default)
ONI_EXPORT_DRIVER(bpa::sim_driver::SimDriver)
#pragma GCC visibility pop
