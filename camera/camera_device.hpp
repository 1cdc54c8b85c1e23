// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "camera/sensor_images.hpp"
#include "core/base/status.hpp"

namespace bpa::camera {

/// What was recorded.
struct RecordingSummary {
  std::string path;
  std::uint32_t frames = 0;  ///< Depth frames.
  std::uint64_t bytes = 0;
};

/// What a camera has to say when it is asked for images.
struct DeviceOutput {
  std::optional<SensorImages> images;  ///< Nothing: none came in time.
  bool busy = false;                   ///< None to show yet, but it works (skipping frames).
  bool ended = false;                  ///< There will be no more: a recording is over.
};

/// A camera that is open: a sensor, a recording or a data set. One thread makes all calls; any of
/// them may hang in a driver.
class CameraDevice {
 public:
  virtual ~CameraDevice() = default;

  /// For people.
  virtual const std::string& name() const = 0;
  /// The next images, waiting no longer than `wait` for them. Fails when the camera is lost: close
  /// it and open it again.
  virtual Result<DeviceOutput> next(std::chrono::milliseconds wait) = 0;
  /// What is wrong while images still come ("depth comes without colour"); empty: nothing.
  virtual std::string complaint() const { return {}; }

  /// Records what the sensor delivers from now on, as it comes from its driver.
  virtual Status start_recording(const std::string& path) {
    return Status(StatusCode::unsupported,
                  name() + " cannot be recorded to " + path + "; only OpenNI2 sensors can");
  }
  /// Completes the file; `not_found` when nothing is being recorded.
  virtual Result<RecordingSummary> stop_recording() {
    return Status(StatusCode::not_found, "nothing is being recorded");
  }
};

/// Opens a camera; called again whenever it is lost. `unavailable` when it is not there.
using OpenCamera = std::function<Result<std::unique_ptr<CameraDevice>>()>;

}  // namespace bpa::camera
