// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/sim/render.hpp"

namespace bpa::sim {

/// How far a pixel of a Kinect may depend on others, pixels: lateral noise at a grazing surface,
/// half a matching window, a speck.
constexpr int kLookAround = 12;

/// A scene with its light, and the camera that looks at it.
struct SensorView {
  const RayScene& scene;
  const Shading& shading;  ///< Holds the materials of the posed meshes.
  Camera camera;           ///< Of the colour image; of the depth image too, if not `registered`.
  Pose world_from_camera;
  /// One byte for each pixel of `camera`: where it is 0, a Kinect that is not `registered` does not
  /// measure, which saves time. Farther than kLookAround pixels from those, the image is the same.
  /// Empty: it measures everywhere. Other sensors ignore it.
  std::span<const std::uint8_t> wanted = {};
};

}  // namespace bpa::sim
