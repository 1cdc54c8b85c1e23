// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/sim/render.hpp"

namespace bpa::sim {

/// A scene with its light, and the camera that looks at it.
struct SensorView {
  const RayScene& scene;
  const Shading& shading;  ///< Holds the materials of the posed meshes.
  Camera camera;           ///< Of the colour image; of the depth image too, if not `registered`.
  Pose world_from_camera;
};

}  // namespace bpa::sim
