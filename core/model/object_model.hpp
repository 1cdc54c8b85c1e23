// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/geometry/symmetry.hpp"
#include "core/model/noise_model.hpp"

namespace bpa {

struct ModelIndex;     // what detection computes from the source; see model_index.hpp
struct OccupancyGrid;  // see occupancy_grid.hpp

/// Where a model's symmetries come from.
enum class SymmetryOrigin {
  none,      ///< Not searched for yet.
  declared,  ///< By the data set or the user, or found and then confirmed by the user.
  found,     ///< In the surface; not confirmed yet.
};

/// What a model file holds; everything else of an ObjectModel follows from it.
struct ModelSource {
  std::string name;      ///< Letters, digits, '_', '-' and '.'; unique in a library.
  int number = 1;        ///< Positive; unique in a library. A BOP data set's obj_id.
  std::string source;    ///< Where it came from, for people: a file name.
  double diameter = 0;   ///< Largest distance of two surface points, metres.
  bool complete = true;  ///< False when the surface was seen from one side only: then its rim is
                         ///< where looking ended, not where the object does.
  SymmetryGroup symmetry;
  SymmetryOrigin symmetry_origin = SymmetryOrigin::none;
  PointCloud surface;  ///< Points, normals, colours where known; object frame, metres. Evenly
                       ///< spaced, only what a camera outside can see.
  /// For each surface point, the mean squared angle between its normal and those that a sensor
  /// reports there, radians squared: large beside creases and where the surface is hard to see.
  std::vector<float> normal_variance;
  NoiseModel noise = usual_noise();   ///< What a sensor is off by.
  std::vector<std::string> warnings;  ///< For people: what may be wrong with the model.
  /// The index of this very surface if it was computed before (a model file holds it); else null.
  std::shared_ptr<const ModelIndex> prepared;
  /// What the views say of the space about the object; null for models made without views, and
  /// where it was not read from the file: detection does not need it.
  std::shared_ptr<const OccupancyGrid> occupancy;
};

/// A known object, ready for detection.
struct ObjectModel : ModelSource {
  std::shared_ptr<const ModelIndex> index;
  /// Of the surface's bounding box; object frame, metres. The origin may lie anywhere.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
};

/// The normal variances that follow from the surface alone: a sensor averages normals over its
/// window, so that they vary as those of the surface within it do.
std::vector<float> geometric_normal_variance(const PointCloud& surface, int num_threads);

/// The mean distance of a point to its nearest neighbour whose normal is within `least_cosine`,
/// metres. Over some 100 of the points; 0 where none has such a neighbour.
float mean_spacing(const PointCloud& surface, float least_cosine);

/// Computes the index, or takes source.prepared, and the normal variances where they are missing.
/// Deterministic.
Result<std::shared_ptr<const ObjectModel>> make_object_model(ModelSource source,
                                                             int num_threads = 0);

}  // namespace bpa
