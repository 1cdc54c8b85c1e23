// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/cloud/match_color.hpp"
#include "core/cloud/planes.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/cloud/surface_map.hpp"
#include "core/features/edges.hpp"
#include "core/features/fpfh.hpp"
#include "core/features/pair_voting.hpp"
#include "core/observation/check_image.hpp"
#include "core/observation/flat_regions.hpp"
#include "core/segment/super_pixels.hpp"

namespace bpa {

/// Scene points that one round of the search looks up in the models.
struct SamplePoints {
  std::vector<int> keypoints;   ///< Indices into SceneFeatures::keypoints.
  std::vector<int> references;  ///< Indices into SceneFeatures::coarse.

  bool empty() const { return keypoints.empty() && references.empty(); }
  bool operator==(const SamplePoints&) const = default;
};

/// How many of SceneFeatures::keypoints and ::references earlier rounds have passed.
struct SampledSoFar {
  std::size_t keypoints = 0, references = 0;
};

/// The points of a round, and what is looked up of them.
struct SceneSample {
  SamplePoints points;
  features::ScenePairs pairs;      ///< Of the references, with points of SceneFeatures::coarse.
  features::ScenePairs rim_pairs;  ///< Of the references, with the rims of their faces.
};

/// What detection reads of a frame; made once, shared by all models. Camera frame, metres.
struct SceneFeatures {
  SurfaceMap map;
  CheckImage image;
  std::vector<Plane> planes;   ///< Labelled background.
  PointCloud surface;          ///< Searched surface, kFeatureSpacing apart, with curvature.
  std::vector<int> keypoints;  ///< Indices into `surface` where FPFH was computed; random order.
  std::vector<features::Fpfh> fpfh;  ///< Of the keypoints.
  PointCloud coarse;                 ///< Searched surface, for point pairs.
  /// Reference points: indices into `coarse`, in a random order that spreads evenly.
  std::vector<int> references;
  std::vector<features::RimPoint> rims;  ///< Of the faces of `coarse`.
  SceneSample sample;                    ///< The first.
  features::SceneEdges edges;
  Image<Eigen::Vector3f> cielab;          ///< Blurred, of the map's size; empty without colour.
  Image<MatchColor> match_colors;         ///< Of `cielab`.
  std::vector<MatchColor> coarse_colors;  ///< `match_colors` at the points of `coarse`.
  Image<Eigen::Vector3f> log_light;       ///< log_light() of `cielab`; empty without patterns.
  Image<Eigen::Vector3f> sharp_light;     ///< log_light() without blur; empty without outlines.
  Image<Eigen::Vector2f> gradients;    ///< color_gradients() of the frame; empty without outlines.
  segment::Segmentation segmentation;  ///< Super-pixels of the whole map.
  FlatRegions flat;                    ///< Where thin objects may lie.
  /// This scene where the flat regions are searched as well; null where there is none.
  std::shared_ptr<const SceneFeatures> with_flat;
};

struct SceneFeatureOptions {
  BPA_OPTION(int, max_keypoints, 300, (10, 100000),
             "Scene points whose features are compared with the models'.");
  BPA_OPTION(int, round_keypoints, 3, (1, 100000),
             "Of these, how many one round matches with the models.");
  BPA_OPTION(int, max_references, 150, (0, 100000),
             "Scene points whose pairs with others vote for poses in one round.");
  double coarse_spacing_m = 0.010;  ///< Spacing of the points that make pairs, metres.
  double pair_reach_m = features::kMaxPairLength;  ///< Length of the longest pairs, metres. What is
                                                   ///< mostly hidden has no long ones.
  int pair_step = 2;  ///< Of the pairs of a point, one in so many votes.
  BPA_OPTION(bool, use_color, true, (), "Use the frame's colours; false ignores them.");
  BPA_OPTION(bool, use_texture, true, (),
             "Compare the patterns of surfaces in colour; false ignores them.");
  BPA_OPTION(bool, use_outline, true, (),
             "Compare outlines with the colour image; false ignores them.");
  BPA_OPTION(bool, use_flat_regions, true, (),
             "Look for thin objects where a plane's colours or heights differ.");
  double color_blur_px = 1.5;  ///< Standard deviation of the blur of the colours, pixels.
  features::EdgeImageOptions edges;
  segment::SuperPixelOptions segments;
  std::uint64_t seed = 0;
  int num_threads = 0;  ///< 0: one per core. Does not change the result.
};

/// The colours of a frame, empty without.
struct ColorImages {
  Image<Eigen::Vector3f> reduced;    ///< reduced_color()
  Image<Eigen::Vector2f> gradients;  ///< color_gradients()
};

/// The next points in random order, without those on pixels that are `explained` (a flag for each
/// pixel of the map; none given: no pixel is). Counts the points that it passes in `passed`.
SamplePoints next_points(const SceneFeatures& scene, std::span<const std::uint8_t> explained,
                         const SceneFeatureOptions& options, SampledSoFar& passed);

/// What is looked up of some points; partners of pairs are not on pixels that are `explained`.
SceneSample scene_sample(const SceneFeatures& scene, SamplePoints points,
                         std::span<const std::uint8_t> explained,
                         const SceneFeatureOptions& options);

/// Sets what scores read of colours: `cielab`, and with the options' patterns and outlines
/// `log_light` and `sharp_light`. `rgb` has the map's size; `sharp_lab` is cielab(rgb).
void add_colors(const Image<Eigen::Vector3f>& rgb, const Image<Eigen::Vector3f>& sharp_lab,
                const SceneFeatureOptions& options, SceneFeatures& scene);

/// `map` with its background labelled.
SceneFeatures scene_features(SurfaceMap map, std::vector<Plane> planes,
                             const SceneFeatureOptions& options, ColorImages colors = {});

}  // namespace bpa
