// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/options.hpp"
#include "core/base/status.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/model/object_model.hpp"

namespace bpa::modeling {

/// Options of making a model from a surface.
struct ModelOptions {
  BPA_OPTION(double, spacing_m, 0.0025, (0.0005, 0.02), "Distance of surface points.");
  BPA_OPTION(int, num_threads, 0, (0, 256), "0 = one per core.");
};

/// The evenly spaced, outwardly visible surface of a mesh or a dense oriented point cloud. Fails
/// with invalid_argument on no surface, or one under 5 mm or over 3 m (with a hint about units).
Result<ModelSource> model_source_from_mesh(const TriangleMesh& mesh, const std::string& name,
                                           int number, const ModelOptions& options = {});
/// The same for points. Normals that are missing or cannot be used (mend_normals()) are estimated:
/// out of a closed surface, else to the origin. Such a cloud is one view of the object, in its
/// camera's frame, and the model is not complete.
Result<ModelSource> model_source_from_points(const PointCloud& cloud, const std::string& name,
                                             int number, const ModelOptions& options = {});

/// Fails with invalid_argument, with a hint about units, for a diameter under 5 mm or over 3 m.
Status check_size(const std::string& name, double diameter);

/// What people should know about a surface of that shape: that it is a single flat face.
std::vector<std::string> shape_warnings(const PointCloud& surface);

}  // namespace bpa::modeling
