// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/cloud/planes.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/cloud/surface_map.hpp"
#include "core/features/edge_image.hpp"
#include "core/features/fpfh.hpp"
#include "core/features/pair_voting.hpp"
#include "core/score/pose_check.hpp"
#include "core/segment/super_pixels.hpp"

namespace bpa {

/// What detection reads of a frame; made once, shared by all models. Camera frame, metres.
struct SceneFeatures {
  SurfaceMap map;
  CheckImage image;
  std::vector<Plane> planes;   ///< Labelled background.
  PointCloud surface;          ///< Searched surface, kFeatureSpacing apart, with curvature.
  std::vector<int> keypoints;  ///< Indices into `surface` where FPFH was computed.
  std::vector<Fpfh> fpfh;      ///< Of the keypoints.
  PointCloud coarse;           ///< Searched surface, for point pairs.
  ScenePairs pairs;            ///< Of points of `coarse`.
  SceneEdges edges;
  Image<Eigen::Vector3f> cielab;  ///< Blurred, of the map's size; empty without colour.
  Segmentation segmentation;      ///< Super-pixels of the whole map.
};

struct SceneFeatureOptions {
  int max_keypoints = 600;
  double coarse_spacing_m = 0.010;
  int max_references = 800;    ///< Points whose pairs vote for poses.
  double pair_reach_m = 0.30;  ///< Longest pairs.
  std::uint64_t seed = 0;
  int num_threads = 0;
};

/// `map` with its background labelled; `rgb` is the frame's reduced_color, empty without colour.
SceneFeatures scene_features(SurfaceMap map, std::vector<Plane> planes,
                             const SceneFeatureOptions& options,
                             const Image<Eigen::Vector3f>& rgb = {});

}  // namespace bpa
