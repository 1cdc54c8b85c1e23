// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/cloud/neighbor_grid.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/features/fpfh.hpp"
#include "core/geometry/pose.hpp"
#include "core/model/object_model.hpp"

namespace bpa::score {

/// Finds features of a model by place. Make one for each model; keeps a reference to it.
class FeaturePlaces {
 public:
  explicit FeaturePlaces(const ObjectModel& model);

  /// The model feature (index into index->fpfh) nearest to a point in the object frame. It is on
  /// the same side of a thin wall; -1 when none is within 1 cm.
  int nearest_to(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const;
  const ObjectModel& model() const { return model_; }

 private:
  const ObjectModel& model_;
  NeighborGrid grid_;
};

/// FPFH score (paper V.8): how well the observed features that lie on the model match the
/// model's there. The average truncated log-likelihood of the distance of the histograms, in
/// [-1, 0]; -1 when no feature lies on the model. `keypoints` index `surface` (camera frame, with
/// normals), `fpfh` is theirs.
double fpfh_score(const PointCloud& surface, std::span<const int> keypoints,
                  std::span<const features::Fpfh> fpfh, const FeaturePlaces& places,
                  const Pose& camera_from_object);

}  // namespace bpa::score
