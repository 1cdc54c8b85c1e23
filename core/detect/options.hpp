// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/options.hpp"
#include "core/geometry/tolerance.hpp"

// The settings of the search for one object, a group for each stage. "V.3" is the third paragraph
// of the paper's section V; README.md lists the paragraphs. Constants stand beside their use. A
// number without a source was chosen by hand on simulated piles (tests/accuracy).

namespace bpa::detect {

/// Gauss-Newton alignment of surface and edges; see refine_pose().
struct RefinementOptions {
  int iterations = 6;    ///< Gauss-Newton steps.
  int max_points = 200;  ///< Surface points of the model used, 1 or more.
  int max_edges = 60;    ///< Edge points of the model used; 0: surface alone.
  /// Largest distances of correspondences in the first step and in the last, metres.
  double start_gate_m = tolerance::placed_m(12), end_gate_m = tolerance::placed_m(4);
};

/// What alignments use, in all stages.
struct AlignOptions {
  BPA_OPTION(bool, use_orientation, true, (),
             "Align with orientations (BPA); false: positions only (ICP, the paper's ablation).");
  BPA_OPTION(bool, use_segments, true, (), "Align to sampled super-pixels; false: to all surface.");
  BPA_OPTION(bool, use_edges, true, (),
             "Align model edges with observed edges; false: surface alone.");
};

struct SampleOptions {
  BPA_OPTION(int, matches_per_keypoint, 1, (1, 20),
             "Nearest model features of each scene keypoint.");
  BPA_OPTION(int, draws_per_match, 1, (1, 50), "Poses drawn by BPA from each correspondence.");
  BPA_OPTION(int, peaks_per_reference, 0, (0, 100),
             "Voted poses of each scene reference point. 0: 2 with colours, 5 without.");
  BPA_OPTION(int, rim_peaks_per_reference, -1, (-1, 100),
             "The same, voted by pairs with the rim of its face. -1: 1 with colours, 2 without; 0: "
             "such pairs are not used.");
  BPA_OPTION(bool, use_colors, true, (),
             "Voted poses lay a reference point on a model point of agreeing colour.");
  BPA_OPTION(int, draws_per_prior, 300, (0, 100000), "Poses drawn from each prior.");
};

struct CheckOptions {
  BPA_OPTION(int, points, 64, (1, 100000),
             "Model points that a pose is checked with. The paper has 500.");
  BPA_OPTION(double, max_free_space, 0.2, (0, 1),
             "Poses with a larger share of points in free space are rejected (V.3).");
  BPA_OPTION(double, free_depth_m, 0.030, (1e-4, 1),
             "A point this far in front of the surface is in free space, metres. The paper has "
             "0.05 (V.3).");
  BPA_OPTION(int, max_kept, 200, (1, 1000000), "Poses that go on.");
  BPA_OPTION(int, max_in_library, 0, (0, 1000000),
             "Poses of all models together that go on. 0: 800, more with over 24 models, and three "
             "times as many without colours.");
};

struct ClusterOptions {
  BPA_OPTION(int, min_features, 2, (1, 100),
             "Clusters with fewer feature correspondences are rejected (V.3). A voted pose stands "
             "for many pairs and is kept alone.");
  BPA_OPTION(int, max_clusters, 60, (1, 10000), "Clusters of one model that go on to round two.");
  BPA_OPTION(int, max_in_library, 0, (0, 1000000),
             "Clusters of all models together that go on. 0: 180, more with over 24 models, and "
             "twice as many without colours.");
};

struct RoundTwoOptions {
  BPA_OPTION(int, bpa_steps, 3, (0, 100), "Alignments by BPA that are proposed (V.6).");
  BPA_OPTION(int, max_in_library, 0, (0, 1000000),
             "Placements of all models together that are aligned and scored in full. 0: 60, more "
             "with over 24 models, and twice as many without colours.");
  int max_pairs = 12;  ///< Surface correspondences of one alignment; half as many of edges.
};

struct RefineOptions {
  BPA_OPTION(int, max_refined, 30, (1, 10000),
             "Placements of one model that are aligned to the end.");
};

struct ClimbOptions {
  BPA_OPTION(int, max_climbed, 3, (0, 10000), "Best placements that climb the score; 0: none.");
};

struct TurnOptions {
  BPA_OPTION(int, max_turned, 12, (0, 10000),
             "Best placements that are tried in near-symmetric poses; 0: none.");
};

struct LayOptions {
  BPA_OPTION(int, max_laid, 4, (0, 10000),
             "Poses at rest on flat regions that are scored in full; 0: none.");
};

struct SelectOptions {
  BPA_OPTION(int, max_placements, 200, (1, 10000),
             "Placements of one model that are returned (section VI).");
};

struct ScoreOptions {
  BPA_OPTION(bool, use_round_three, true, (),
             "Score with edges, random walks, segments, features, colours and rivals; false leaves "
             "these components unknown.");
  BPA_OPTION(bool, stop_early, true, (),
             "Reject a placement as soon as its first score components make it improbable.");
  BPA_OPTION(double, keep_right, 0.999, (0, 1),
             "Share of the right candidates that each limit on log odds keeps. 1: no candidate is "
             "rejected for its log odds. The score layers hold the limits.");
};

/// The search for one object.
struct DetectOptions {
  BPA_GROUP(AlignOptions, align, "What alignments use.");
  BPA_GROUP(ScoreOptions, score, "What placements are scored with.");
  BPA_GROUP(SampleOptions, sample, "Poses from features, point pairs and priors.");
  BPA_GROUP(CheckOptions, check, "Free space.");
  BPA_GROUP(ClusterOptions, cluster, "Groups of poses.");
  BPA_GROUP(RoundTwoOptions, round_two, "Alignment to sampled segments.");
  BPA_GROUP(RefineOptions, refine, "Alignment to the end.");
  BPA_GROUP(ClimbOptions, climb, "Hill climbing of the score.");
  BPA_GROUP(TurnOptions, turn, "Near symmetries.");
  BPA_GROUP(LayOptions, lay, "Thin objects at rest on a plane.");
  BPA_GROUP(SelectOptions, select, "What is returned.");
};

}  // namespace bpa::detect
