// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "core/geometry/pose.hpp"
#include "core/model/model_index.hpp"
#include "core/observation/scene_features.hpp"

namespace bpa {

/// A model point and the observed surface at the pixel that it falls on. Camera frame, metres.
struct SurfaceMatch {
  Eigen::Vector3f model_point, model_normal;
  Eigen::Vector3f scene_point, scene_normal;
  std::size_t pixel = 0;
};

/// Matches the i-th of `points` at a pose. False where it faces away, leaves the image or falls on
/// background, or the surface is `gate` metres away or turned by more than 53 degrees.
bool match_surface(const SceneFeatures& scene, const CheckPoints& points, std::size_t i,
                   const FastPose& pose, float gate, SurfaceMatch& match);

}  // namespace bpa
