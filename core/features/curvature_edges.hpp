// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/options.hpp"
#include "core/cloud/image.hpp"
#include "core/cloud/surface_map.hpp"

namespace bpa {

/// The defaults are chosen by hand.
struct CurvatureEdgeOptions {
  double baseline_m = 0.010;
  double min_concavity = 30;
  double max_baseline_px = 8;
  int num_threads = 0;  ///< 0: one for each core.

  template <class Visitor>
  void visit_fields(Visitor&& visit) {
    visit("baseline_m", baseline_m,
          FieldRule{0.001, 0.1, "Normals this far to either side are compared, metres."});
    visit("min_concavity", min_concavity,
          FieldRule{0, 1000, "Least concavity of an edge, 1 / radius of the hollow, per metre."});
    visit("max_baseline_px", max_baseline_px,
          FieldRule{1, 50, "Largest baseline in the image, pixels."});
  }
};

/// The lowest normal curvature among the four directions of the grid and its diagonals, per metre:
/// (n1 - n2) . (p1 - p2) / |p1 - p2|^2 over points p and normals n on either side. Negative where
/// the surface is hollow, -1/r in a trough of radius r, 1/r on a ball; 0 where it is not known, and
/// across range edges.
struct HollowMap {
  Image<float> curvature;
  Image<std::uint8_t> direction;  ///< 0..3: of the lowest, see kHollowDirections.
};
constexpr int kHollowDirections[4][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}};
HollowMap hollow_map(const SurfaceMap& map, const CurvatureEdgeOptions& options = {});

/// High negative curvature (paper section V), where objects touch: 1 along the bottom of a hollow,
/// which is where the lowest curvature is lower than on either side, else 0.
Image<std::uint8_t> curvature_edges(const SurfaceMap& map,
                                    const CurvatureEdgeOptions& options = {});

}  // namespace bpa
