// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/options.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/geometry/pose.hpp"
#include "core/geometry/symmetry.hpp"

// The paper's experiment of BPA against ICP (its section "BPA vs. ICP"), on plain clouds: match,
// align, match again.

namespace bpa::cli {

/// One object that is truly in a scene. Both clouds have normals, and curvatures with principal
/// directions where those are to count.
struct TruePlacement {
  const PointCloud* model = nullptr;  ///< Object frame.
  const PointCloud* scene = nullptr;  ///< Camera frame, the whole scene, normals to the camera.
  Pose camera_from_object;
  SymmetryGroup symmetry;
};

struct ConvergenceOptions {
  BPA_OPTION(int, starts, 50, (1, 100000), "Noisy starts for each true placement.");
  BPA_OPTION(int, iterations, 20, (1, 1000), "Alignment steps from each start.");
  BPA_OPTION(int, points, 10, (3, 1000), "Scene points matched in a step.");
  BPA_OPTION(double, start_position_m, 0.01, (0, 1),
             "Standard deviation of a start's position per axis, metres.");
  BPA_OPTION(double, start_angle_deg, 8, (0, 180),
             "Standard deviation of a start's rotation per axis, degrees.");
  BPA_OPTION(double, gate_m, 0.03, (0.001, 1), "Largest distance of a match, metres.");
  BPA_OPTION(double, patch_m, 0.02, (0.001, 1), "Size of scene patches, metres.");
  BPA_OPTION(double, assign_m, 0.015, (1e-4, 1),
             "Distance at which a scene point fits the model, metres.");
  BPA_OPTION(double, assign_deg, 22.5, (1, 180),
             "Angle between normals at which a scene point fits the model, degrees.");
  BPA_OPTION(double, sigma_m, 0.01, (1e-5, 1),
             "Standard deviation of a match's position for BPA, metres.");
  BPA_OPTION(std::uint64_t, seed, 0, (0, 1.8e19), "Same seed, same answer.");
  BPA_OPTION(int, num_threads, 0, (0, 256), "0 = one per core.");
};

/// Entry k: the mean over all trials of the least error within the first k steps; entry 0 is the
/// start's.
struct ConvergenceCurve {
  std::vector<double> position_m;
  std::vector<double> angle_rad;
};

struct ConvergenceResult {
  ConvergenceCurve bpa = {};          ///< Normals and curvature directions, as in the paper.
  ConvergenceCurve bpa_normals = {};  ///< Normals only.
  ConvergenceCurve icp = {};
  int trials = 0;
};

/// From each start, each step samples scene points near the placed model at random. Each is matched
/// with its nearest model point on the side that faces the camera. Both methods get the same
/// samples at the same pose. Errors are modulo the symmetry. Does not depend on num_threads.
ConvergenceResult run_convergence(const std::vector<TruePlacement>& placements,
                                  const ConvergenceOptions& options = {});

}  // namespace bpa::cli
