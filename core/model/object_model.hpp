// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <bpa/core/base/options.hpp>
#include <bpa/core/base/status.hpp>
#include <bpa/core/cloud/point_cloud.hpp>
#include <bpa/core/geometry/symmetry.hpp>

namespace bpa {

/// What a model file holds; everything else of an ObjectModel follows from it.
struct ModelSource {
  std::string name;      ///< Letters, digits, '_', '-' and '.'; unique in a library.
  int number = 1;        ///< Positive; unique in a library. A BOP data set's obj_id.
  std::string source;    ///< Where it came from, for people: a file name.
  double diameter = 0;   ///< Largest distance of two surface points, metres.
  bool complete = true;  ///< False when the surface was seen from one side only: then its rim is
                         ///< where looking ended, not where the object does.
  SymmetryGroup symmetry;
  PointCloud surface;  ///< Points, normals, colours where known; object frame, metres. Evenly
                       ///< spaced, only what a camera outside can see.
};

struct ModelIndex;  // what detection computes from the source; see model_index.hpp

/// A known object, ready for detection.
struct ObjectModel : ModelSource {
  std::shared_ptr<const ModelIndex> index;
};

/// Options of making a model from a surface.
struct ModelOptions {
  double spacing_m = 0.0025;  ///< Distance of neighbouring surface points.
  int num_threads = 0;

  template <class Visitor>
  void visit_fields(Visitor&& visit) {
    visit("spacing_m", spacing_m, FieldRule{0.0005, 0.02, "Distance of surface points."});
    visit("num_threads", num_threads, FieldRule{0, 256, "0 = one per core."});
  }
};

/// The evenly spaced, outwardly visible surface of a mesh or of a dense oriented point cloud.
/// Fails with invalid_argument on an empty surface and on one larger than 3 m or smaller than 5 mm
/// (with a hint about units).
Result<ModelSource> model_source_from_mesh(const TriangleMesh& mesh, const std::string& name,
                                           int number, const ModelOptions& options = {});
/// The same for points. Where the cloud has no normals they are estimated, and point to the origin:
/// such a cloud is one view of the object, in its camera's frame, and the model is not complete.
Result<ModelSource> model_source_from_points(const PointCloud& cloud, const std::string& name,
                                             int number, const ModelOptions& options = {});

/// Computes the index. Deterministic.
Result<std::shared_ptr<const ObjectModel>> make_object_model(ModelSource source,
                                                             int num_threads = 0);

}  // namespace bpa
