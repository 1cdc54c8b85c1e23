// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/cloud/point_cloud.hpp"

namespace bpa {

/// Fills principal_directions and curvatures of a cloud with normals: the eigen-decomposition of
/// the covariance of the neighbours' normals in the tangent plane (paper, appendix, footnote).
/// Neighbours whose normals differ by more than 100 degrees (the far side of a thin wall) do not
/// count.
void estimate_curvature(PointCloud& cloud, float radius, int num_threads);

}  // namespace bpa
