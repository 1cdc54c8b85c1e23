// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

#include "camera/openni2_sim/sim_stream.hpp"

namespace bpa::sim_driver {

/// The opened device: two streams and the thread that shows them the frames at 30 Hz.
class SimDevice : public oni::driver::DeviceBase {
 public:
  SimDevice(SimFrames frames, const SimConfig& config);
  ~SimDevice() override;

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override;
  oni::driver::StreamBase* createStream(OniSensorType sensor) override;
  void destroyStream(oni::driver::StreamBase* stream) override;
  OniStatus setProperty(int id, const void* data, int size) override;
  OniStatus getProperty(int id, void* data, int* size) override;
  OniBool isPropertySupported(int id) override;
  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override;
  OniStatus tryManualTrigger() override;

 private:
  void run();

  const SimFrames frames_;
  const SimConfig& config_;
  std::array<std::vector<OniVideoMode>, 2> modes_;
  std::array<OniSensorInfo, 2> sensors_{};
  std::atomic<bool> registering_{false};
  std::mutex mutex_;  ///< Guards the list; held while frames are shown.
  std::vector<SimStream*> streams_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;  ///< Last: starts when all else is there.
};

}  // namespace bpa::sim_driver
