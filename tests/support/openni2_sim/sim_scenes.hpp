// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/geometry/camera.hpp"

// What the simulated device shows and how it behaves. The environment variable BPA_SIM names
//
//   - a folder in the BOP layout (`bpa simulate scenes` makes one). Its frames are shown in turn.
//   - or a YAML file that simulates faults. It is read again whenever it changes:
//
//     scenes: DIR                 the folder, relative to the file
//     split: test
//     plugged: true               false: the device is not there (pulled out)
//     deliver: true               false: streams bring no frames any more
//     deliver_color: true         false: depth comes without colour
//     wedged: false               true: calls into the driver do not return
//     color_sensor: true          false: a device without a colour camera
//     fine_depth: false           true: depth in 0.1 mm only
//     registration: device        pretended: says that it registers and does not; none: cannot
//
// Without BPA_SIM there is no device.

namespace oni::driver {
class DeviceBase;
}

namespace bpa::sim_driver {

/// The settings now. Thread-safe; those that are no atomics do not change after the first reading.
class SimConfig {
 public:
  /// Reads what BPA_SIM names.
  SimConfig();

  /// Reads the file again; a file that cannot be read (half written, say) changes nothing.
  void refresh();
  /// Waits as long as the driver is wedged.
  void pass() const;

  std::string scenes;  ///< Empty: there is no device.
  std::string split = "test";
  bool fine_depth = false;
  std::atomic<bool> plugged{true};
  std::atomic<bool> deliver{true};
  std::atomic<bool> deliver_color{true};
  std::atomic<bool> wedged{false};
  std::atomic<bool> color_sensor{true};
  std::atomic<bool> can_register{true};  ///< As the device says.
  std::atomic<bool> registers{true};     ///< As it does when it is asked to.

 private:
  std::string file_;
  std::string text_;  ///< Of the file, as read last.
};

/// The colour camera stands this far to the right of the depth camera, metres (a Kinect's 2.5 cm).
inline constexpr double kBaseline = 0.025;

/// One scene as both cameras see it, row-major.
struct SimFrame {
  std::vector<std::uint8_t> rgb;
  std::vector<std::uint16_t> registered;    ///< 0.1 mm, in the colour camera; 0 where none.
  std::vector<std::uint16_t> unregistered;  ///< 0.1 mm, in the depth camera.
};

struct SimFrames {
  Camera color;
  Camera depth;
  std::vector<SimFrame> frames;
};

/// Loads the frames of a data set (at most 60). The depth camera's own view is SCENE/depth_ir/*.png
/// with the camera of DATASET/camera_ir.json where they are there; otherwise it is made by moving
/// the registered depth, with the colour camera's intrinsics. Frames must have one size and camera.
Result<SimFrames> load_sim_frames(const std::string& dataset, const std::string& split);

/// The opened device: a depth and a colour stream, and the thread that shows them the frames at
/// 30 Hz. The caller deletes it; `config` outlives it.
oni::driver::DeviceBase* new_sim_device(SimFrames frames, const SimConfig& config);

}  // namespace bpa::sim_driver
