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

struct ModelIndex;
struct ModelView;      // what detection computes from the source; see model_index.hpp
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

/// A surface point that a view shows, with all that scoring reads of it.
struct ViewPoint {
  Eigen::Vector3f point, normal, soft_normal;  ///< See ModelIndex::soft_normals.
  float edge_distance = 0;                     ///< See ModelView::edge_distance.
  float normal_variance = 0;                   ///< See ModelSource::normal_variance.
};

/// Surface points that a view shows, number beside number, for vector instructions. Lanes that hold
/// no point have a normal of zero.
struct ViewBlock {
  static constexpr int kSize = 32;
  float point[3][kSize] = {}, normal[3][kSize] = {}, soft_normal[3][kSize] = {};
  float edge_distance[kSize] = {}, normal_variance[kSize] = {};

  void set(int lane, const ViewPoint& from);
};

/// A point on a range edge of a view; see ModelView::outward.
struct ViewEdge {
  Eigen::Vector3f point, normal, outward;
};

/// Edge points of a view, number beside number, for vector instructions. Lanes that hold none are
/// zero.
struct EdgeBlock {
  static constexpr int kSize = 16;
  float point[3][kSize] = {}, normal[3][kSize] = {}, outward[3][kSize] = {};

  void set(int lane, const ViewEdge& from);
  ViewEdge at(int lane) const;
};

/// Points of one view, side by side in memory: the surface as a whole is larger than the cache. Any
/// first part of them is spread over the view.
struct ViewSample {
  static constexpr std::size_t kMost = 256;  ///< Of each kind.
  std::size_t num_points = 0, num_edges = 0;
  std::vector<ViewBlock> points;
  std::vector<EdgeBlock> edges;

  ViewEdge edge(std::size_t k) const {
    return edges[k / EdgeBlock::kSize].at(static_cast<int>(k % EdgeBlock::kSize));
  }
};

/// A known object, ready for detection.
struct ObjectModel : ModelSource {
  std::shared_ptr<const ModelIndex> index;
  std::vector<ViewSample> view_samples;  ///< Of each of index->views.
  /// Of the surface's bounding box; object frame, metres. The origin may lie anywhere.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
};

/// The k-th point that a view of the index shows.
ViewPoint view_point(const ObjectModel& model, const ModelView& view, std::size_t k);
/// The k-th edge point of a view of the index.
ViewEdge view_edge(const ObjectModel& model, const ModelView& view, std::size_t k);
/// The sample of a view of the index.
const ViewSample& sample_of(const ObjectModel& model, const ModelView& view);

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
