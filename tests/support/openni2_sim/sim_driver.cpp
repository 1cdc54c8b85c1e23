// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <utility>

#include <openni2/Driver/OniDriverAPI.h>

#include "tests/support/openni2_sim/sim_scenes.hpp"

namespace bpa::sim_driver {
namespace {

constexpr const char* kUri = "bpa-sim";

/// Announces the device while it is plugged in, opens and closes it.
class SimDriver : public oni::driver::DriverBase {
 public:
  explicit SimDriver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback state_changed,
                       void* cookie) override {
    const OniStatus status = DriverBase::initialize(connected, disconnected, state_changed, cookie);
    if (status != ONI_STATUS_OK || config_.scenes.empty()) return status;
    follow();
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
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
    return new_sim_device(std::move(frames).value(), config_);
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

  void shutdown() override { thread_ = {}; }

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
  std::jthread thread_;  ///< Last: runs while all else is there.
};

}  // namespace
}  // namespace bpa::sim_driver

// What the macro of OniDriverAPI.h takes from a header that Debian does not ship.
#define XN_NEW(type, argument) new type(argument)
#define XN_DELETE(pointer) delete pointer
#pragma GCC visibility push(default)
ONI_EXPORT_DRIVER(bpa::sim_driver::SimDriver)
#pragma GCC visibility pop
