// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/sim/objects.hpp"
#include "core/sim/render.hpp"

namespace bpa::sim {

/// The share of the object's telltales that is in sight. The object is the scene's first posed
/// mesh.
double telltales_in_sight(const SimulatedObject& object, const RayScene& scene,
                          const Camera& camera, const Pose& world_from_camera);

/// Whether none of the object's telltales is in sight, and at least a tenth of its vertices is.
/// The object is the scene's first posed mesh.
bool telltales_hidden(const SimulatedObject& object, const RayScene& scene, const Camera& camera,
                      const Pose& world_from_camera);

}  // namespace bpa::sim
