// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/geometry/camera.hpp"

namespace bpa::camera {

enum class PixelFormat {
  depth_mm,  ///< uint16, millimetres; 0: not measured.
  depth_m,   ///< float, metres; 0: not measured.
  rgb,       ///< 3 bytes: red, green, blue.
  grey       ///< 1 byte.
};

constexpr std::size_t bytes_per_pixel(PixelFormat format) {
  constexpr std::size_t kBytes[] = {2, 4, 3, 1};
  return kBytes[static_cast<std::size_t>(format)];
}

/// Row-major pixels without padding, little-endian.
struct Image {
  PixelFormat format = PixelFormat::depth_mm;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> bytes;  ///< width * height * bytes_per_pixel(format).
};

/// The pixels of an image as its bytes.
template <class Pixel>
std::vector<std::uint8_t> bytes_of(const std::vector<Pixel>& pixels) {
  const auto* first = reinterpret_cast<const std::uint8_t*>(pixels.data());
  return {first, first + sizeof(Pixel) * pixels.size()};
}

/// Depth and colour of one moment.
struct SensorImages {
  std::int64_t stamp_ns = 0;  ///< Time of exposure, Unix time of this machine.
  std::string frame_id;       ///< Of a recording of ROS 2; else empty.
  Image depth;
  std::optional<Image> color;      ///< Nothing: the camera gave depth alone.
  Camera camera;                   ///< Pinhole camera of both images.
  std::vector<double> distortion;  ///< k1 k2 p1 p2 k3 ... of both images; empty: none. At most 8.
};

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
  /// The next images, after `wait` at most. Fails when the camera is lost: open it again then.
  virtual Result<DeviceOutput> next(std::chrono::milliseconds wait) = 0;
  /// What is wrong while images still come ("depth comes without colour"); empty: nothing.
  virtual std::string complaint() const { return {}; }

  /// Records what the sensor delivers from now on, as it comes from its driver.
  virtual Status start_recording(const std::string& path) {
    return Status(StatusCode::unsupported,
                  name() + " cannot be recorded to " + path + "; only OpenNI2 sensors can");
  }
  /// Of the recording that is being made; fails when it cannot be written any further.
  virtual Result<std::uint64_t> recorded_bytes() const { return std::uint64_t{0}; }
  /// Completes the file; `not_found` when nothing is being recorded.
  virtual Result<RecordingSummary> stop_recording() {
    return Status(StatusCode::not_found, "nothing is being recorded");
  }
};

/// Opens a camera; called again whenever it is lost. `unavailable` when it is not there.
using OpenCamera = std::function<Result<std::unique_ptr<CameraDevice>>()>;

}  // namespace bpa::camera
