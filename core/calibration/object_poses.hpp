// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/base/status.hpp"
#include "core/geometry/symmetry.hpp"
#include "core/result/placement.hpp"

// Where cameras are by objects that several of them see.

namespace bpa::calibration {

/// What one camera sees at one moment: placements in its own frame.
using SeenObjects = std::vector<Placement>;

/// One camera by the objects that it shares with others.
struct CameraByObjects {
  Pose scene_from_camera;
  int objects = 0;        ///< Its placements that agree with those of other cameras.
  double position_m = 0;  ///< Root mean square distance of these, metres.
  double angle_rad = 0;   ///< Root mean square turn of these, modulo the symmetry.
};

/// Finds all cameras from moments of one scene each. `moments[m][c]` is what camera c sees at
/// moment m; each moment has as many cameras. The fixed frame is that of `first`, the pose of
/// camera 0. Each pair of objects of one model gives a guess, for each element of its symmetry
/// group. The guess that brings most objects together within 3 cm and 15 degrees is kept (RANSAC
/// over all pairs, Fischler and Bolles 1981) and refined by Gauss-Newton, weighted by the
/// placements' covariances. Cameras join one by one, that with most common objects first. Fails
/// with invalid_argument on fewer than two cameras, and with not_found where a camera shares fewer
/// than two objects with the others. Deterministic.
Result<std::vector<CameraByObjects>> cameras_from_objects(
    std::span<const std::vector<SeenObjects>> moments,
    const std::function<SymmetryGroup(const std::string& model)>& symmetry_of,
    const Pose& first = {});

}  // namespace bpa::calibration
