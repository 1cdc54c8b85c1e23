// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/geometry/camera.hpp"

namespace bpa::sim_driver {

/// The colour camera stands so far to the right of the depth camera, metres (a Kinect's 2.5 cm).
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

}  // namespace bpa::sim_driver
