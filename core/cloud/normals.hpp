// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/cloud/point_cloud.hpp"

// Normals where there are none, and normals of others: of files.

namespace bpa {

/// Fills normals of a cloud by plane fits to the neighbours within `radius`, toward `viewpoint`.
void estimate_normals(PointCloud& cloud, float radius, const Eigen::Vector3f& viewpoint,
                      int num_threads);

/// Replaces normals that are zero or not finite by computed ones. False if all of them cannot be
/// used: a fifth or more is so, or over 60 degrees from the computed one, whatever its sign. A
/// computed normal of zero is not known, and tells nothing.
bool mend_normals(std::vector<Eigen::Vector3f>& normals,
                  const std::vector<Eigen::Vector3f>& computed);

/// The same by the triangles' winding. A mesh whose normals cannot be used has none.
void mend_normals(TriangleMesh& mesh);

}  // namespace bpa
