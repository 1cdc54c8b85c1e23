// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/cloud/point_cloud.hpp"
#include "core/geometry/pose.hpp"
#include "core/model/object_model.hpp"

namespace bpa::modeling {

/// A way of laying one surface onto another.
struct Registration {
  Pose target_from_source;
  double overlap = 0;  ///< Share of the source's points on the target, facing the same way.
  double rms = 0;      ///< Of these points' distances to the target's tangent planes, metres.
};

struct RegistrationOptions {
  double tolerance_m = 0.005;  ///< What counts as lying on the surface.
  int draws = 3000;            ///< Point pairs of the source that are looked up.
  int kept = 30;               ///< Different ways that are refined and returned.
  std::uint64_t seed = 0;
  int num_threads = 0;
};

/// All good ways of laying `source` onto `target` from anywhere, best overlap first: poses from
/// oriented point pairs, checked on a sample, refined by point-to-plane ICP. Both clouds need
/// normals; they may cover different parts of one object. Symmetric objects have many such ways.
std::vector<Registration> register_surfaces(const PointCloud& source, const PointCloud& target,
                                            const RegistrationOptions& options);

/// Whether the diameters of two models are within 4 %.
bool same_size(const ModelSource& a, const ModelSource& b);

/// Whether two models have nearly the same size and shape, colours aside, so that one may be taken
/// for the other. At once for models of other sizes, else about a second.
bool same_shape(const ModelSource& a, const ModelSource& b, int num_threads = 0);

}  // namespace bpa::modeling
