// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/pose.hpp"
#include "core/io/mesh_file.hpp"

namespace bpa::eval {

/// The depth of a mesh at a pose: row-major, metres along z at pixel centres; 0 where there is
/// nothing. Triangles nearer than 1 cm are left out, both sides of the others are seen.
std::vector<float> render_depth(const TriangleMesh& mesh, const Pose& camera_from_object,
                                const Camera& camera);

}  // namespace bpa::eval
