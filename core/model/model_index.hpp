// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/cloud/match_color.hpp"
#include "core/features/fpfh.hpp"
#include "core/features/pair_voting.hpp"
#include "core/model/distance_transform.hpp"
#include "core/model/flat_rest.hpp"
#include "core/model/object_model.hpp"
#include "core/model/view_sphere.hpp"

namespace bpa {

constexpr float kFeatureSpacing = 0.005f;   ///< Of the cloud that FPFH is computed on, metres.
constexpr float kFeatureRadius = 0.025f;    ///< Of the FPFH neighbourhood, metres.
constexpr float kCurvatureRadius = 0.015f;  ///< Of the neighbourhood of a principal direction.

/// Points of a model for fast checks of a pose: in random order, so that any first part is a fair
/// sample; coordinate by coordinate, so that several are checked at once.
struct CheckPoints {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<std::uint32_t> surface;  ///< Which point of the surface each one is.
  /// The same again: x, y, z of the points, then of the normals; each padded to a multiple of
  /// kCheckBlock with points that face nowhere.
  std::vector<float> coordinates[6];
};

constexpr int kCheckBlock = 8;  ///< Points that are checked together.

/// What detection looks up in a model.
struct ModelIndex {
  /// Normals of the surface points, averaged over what a fitted normal averages over: what a
  /// sensor reports beside a crease.
  std::vector<Eigen::Vector3f> soft_normals;
  CheckPoints check;                       ///< Up to 1024 surface points.
  PointCloud features;                     ///< With curvature, kFeatureSpacing apart.
  std::vector<features::Fpfh> fpfh;        ///< Of `features`.
  features::FeatureTree feature_tree{{}};  ///< Over `fpfh`.
  PointCloud coarse;                       ///< What `pairs` and `rim_pairs` are made of.
  std::vector<MatchColor> palette;         ///< Of the entries of `pairs`; empty without colours.
  features::PointPairTable pairs{{}, 1};
  features::PointPairTable rim_pairs{{}, {}, 1};  ///< Empty where the model is not complete.
  std::vector<ModelView> views;                   ///< The 66 views, over `surface`.
  DistanceTransform distances;                    ///< Of `surface`.
  NoiseTable noise;                               ///< Of the model's noise.
  std::vector<Eigen::Vector3f> cielab;            ///< Of the surface points; empty without colours.
  std::vector<Eigen::Vector3f> log_light;         ///< log_light() of `cielab`.
  /// Means of `cielab` about the points of `coarse` and the first of `check`; empty without
  /// colours.
  std::vector<MatchColor> coarse_colors, check_colors;
  std::vector<FlatRest> flat_rests;   ///< flat_rests() of the surface.
  std::vector<Pose> near_symmetries;  ///< near_symmetries() of the surface.
  double point_area = 0;  ///< Surface that each surface point stands for, square metres.
};

/// Of a model with an index, square metres.
inline double surface_area(const ObjectModel& model) {
  return model.index->point_area * static_cast<double>(model.surface.size());
}

/// Counts up whenever build_index() gives another index for the same surface, so that stored ones
/// are told from current ones.
constexpr int kIndexVersion = 4;

/// The index of a model's surface, which must have normals.
std::shared_ptr<ModelIndex> build_index(const ModelSource& source, int num_threads);

/// The parts of an index that are not in a file because they are quick to compute: check points,
/// the tree over `fpfh`, the noise table, mean colours.
void derive_index(const ModelSource& source, ModelIndex& index);

/// near_symmetries() of a model's surface, by `distances` and `check` of its index. An index is of
/// one symmetry group: these change with it.
std::vector<Pose> near_symmetries_of(const ModelSource& source, const ModelIndex& index);

}  // namespace bpa
