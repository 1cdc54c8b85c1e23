// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/options.hpp"
#include "core/cloud/surface_map.hpp"
#include "core/geometry/pose.hpp"

// Whether several cameras see one scene in the same place: the surfaces of their depth images,
// compared in the fixed frame.

namespace bpa::calibration {

/// The surface that one camera sees, and where the camera is said to be.
struct PosedSurface {
  const SurfaceMap* map = nullptr;
  Pose scene_from_camera;
};

struct SurfaceAlignmentOptions {
  BPA_OPTION(int, iterations, 12, (1, 100), "Gauss-Newton steps.");
  BPA_OPTION(int, max_points, 3000, (100, 100000), "Points of each view that are compared.");
  BPA_OPTION(double, start_gate_m, 0.030, (0.001, 0.2),
             "Largest distance of a point to the other view's surface, first step, m.");
  BPA_OPTION(double, end_gate_m, 0.008, (0.001, 0.2), "The same of the last step, m.");
  BPA_OPTION(double, position_sigma_m, 0.010, (1e-4, 1),
             "Expected error of a camera's position, standard deviation, m.");
  BPA_OPTION(double, angle_sigma_deg, 1, (1e-3, 45),
             "Expected error of a camera's orientation, standard deviation, degrees.");
  BPA_OPTION(int, min_matches, 200, (10, 100000),
             "Two views with fewer common points are not compared.");
};

/// How far the surfaces of two views are apart in the fixed frame.
struct SurfaceDisagreement {
  int first = 0, second = 0;  ///< Indices of the views.
  int matches = 0;            ///< Points of both that lie on the other's surface, at the end.
  double residual_m = 0;      ///< Median distance of a point to the other's tangent plane, before.
  double aligned_m = 0;       ///< The same after the second camera is moved onto the first.
  double position_m = 0;      ///< That motion at the middle of the common surface.
  double angle_rad = 0;       ///< Its rotation, 0 to π.
};

/// Where the cameras are by their surfaces.
struct SurfaceAlignment {
  /// Of each view. Where surfaces leave a motion open, cameras stay where they were said to be. The
  /// mean error is not observable: each camera moves as little as possible.
  std::vector<Pose> scene_from_camera;
  std::vector<SurfaceDisagreement> pairs;  ///< Pairs with at least min_matches common points.
};

/// Projective point-to-plane ICP (Blais and Levine 1995) of all views together: a point is matched
/// with the pixel of the other view that it falls on. Tukey weights; a Gaussian prior on each
/// camera's error. Every pair is also aligned by itself, for `pairs`. Deterministic.
SurfaceAlignment align_surfaces(std::span<const PosedSurface> views,
                                const SurfaceAlignmentOptions& options = {});

/// One sentence for people that names both cameras and says by how much they disagree.
std::string disagreement_text(const SurfaceDisagreement& pair, const std::string& first,
                              const std::string& second);

}  // namespace bpa::calibration
