// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstring>
#include <mutex>
#include <vector>

#include <openni2/Driver/OniDriverAPI.h>

#include "camera/openni2_sim/sim_scenes.hpp"

namespace bpa::sim_driver {

/// Hands out the value of a property, as OpenNI2 asks for it.
template <class T>
OniStatus give(const T& value, void* data, int* size) {
  if (*size < static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof(T));
  *size = sizeof(T);
  return ONI_STATUS_OK;
}

/// Takes the value of a property, as OpenNI2 sets it.
template <class T>
OniStatus take(const void* data, int size, T& value) {
  if (size != static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(&value, data, sizeof(T));
  return ONI_STATUS_OK;
}

/// The modes of one sensor: the size of the frames and half of it, at 30 and 15 Hz; `fine_depth`
/// leaves out those with depth in millimetres.
std::vector<OniVideoMode> modes_of(OniSensorType sensor, const Camera& camera, bool fine_depth);

/// The depth or the colour stream. OpenNI2's threads set properties and start and stop it while the
/// device's thread shows frames.
class SimStream : public oni::driver::StreamBase {
 public:
  /// `registering` is the device's switch.
  SimStream(OniSensorType sensor, const std::vector<OniVideoMode>& modes, const SimFrames& frames,
            const SimConfig& config, const std::atomic<bool>& registering);
  ~SimStream() override { set_running(false); }

  OniStatus setProperty(int id, const void* data, int size) override;
  OniStatus getProperty(int id, void* data, int* size) override;
  OniBool isPropertySupported(int id) override;
  void notifyAllProperties() override;
  OniStatus start() override {
    set_running(true);
    return ONI_STATUS_OK;
  }
  void stop() override { set_running(false); }

  /// Delivers the tick's frame if the stream runs and its rate wants it. Ticks come at 30 Hz.
  void show(std::uint64_t tick, std::uint64_t timestamp_us);

 private:
  void set_running(bool running);
  /// Whether depth is shown as its own camera sees it, not as the colour camera would.
  bool in_own_view() const { return depth_ && !(registering_ && config_.registers); }
  void fill(const SimFrame& scene, OniFrame& frame) const;
  /// The field of a property that can be set freely; nullptr for any other.
  int* setting(int id);

  const bool depth_;
  const std::vector<OniVideoMode>& modes_;
  const SimFrames& frames_;
  const SimConfig& config_;
  const std::atomic<bool>& registering_;
  std::mutex mutex_;  ///< Guards what follows.
  OniVideoMode mode_;
  int mirrored_ = TRUE;  ///< As real devices start.
  int auto_exposure_ = TRUE;
  int auto_white_balance_ = TRUE;
  int exposure_ = 100;  ///< Per cent of what the scene was rendered with.
  int gain_ = 100;
  bool running_ = false;
};

}  // namespace bpa::sim_driver
