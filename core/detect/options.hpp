// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/options.hpp"
#include "core/score/pose_check.hpp"

// The settings of the search for one object, a group for each stage. "V.3" is the third paragraph
// of the paper's section V; README.md lists the paragraphs. A number without a source was chosen by
// hand on simulated piles (tests/accuracy).

namespace bpa {

/// Gauss-Newton alignment of surface and edges; see refine_pose().
struct RefinementOptions {
  int iterations = 6;
  int max_points = 200;
  int max_edges = 60;
  double start_gate_m = 0.030;
  double end_gate_m = 0.010;

  void visit_fields(auto&& visit) {
    visit("iterations", iterations, {0, 100, "Gauss-Newton steps."});
    visit("max_points", max_points, {1, 100000, "Surface points of the model used."});
    visit("max_edges", max_edges, {0, 100000, "Edge points of the model used; 0: surface alone."});
    visit("start_gate_m", start_gate_m,
          {1e-4, 1, "Largest distance of correspondences in the first step, metres."});
    visit("end_gate_m", end_gate_m,
          {1e-4, 1, "Largest distance of correspondences in the last step, metres."});
  }
};

/// What alignments use, in all stages.
struct AlignOptions {
  bool use_orientation = true;
  bool use_segments = true;
  bool use_edges = true;

  void visit_fields(auto&& visit) {
    visit("use_orientation", use_orientation,
          {0, 1,
           "Align with orientations (BPA); false: positions only (ICP, the paper's "
           "ablation)."});
    visit("use_segments", use_segments,
          {0, 1, "Align to sampled super-pixels; false: to all surface."});
    visit("use_edges", use_edges,
          {0, 1, "Align model edges with observed edges; false: surface alone."});
  }
};

struct SampleOptions {
  int matches_per_keypoint = 1;
  int draws_per_match = 1;
  int peaks_per_reference = 2;
  int rim_peaks_per_reference = 1;
  bool use_colors = true;
  int draws_per_prior = 300;
  double feature_sigma_m = 0.004;
  double pair_sigma_m = 0.008;
  RefinementOptions prior_alignment{4, 100, 30, 0.050, 0.015};

  void visit_fields(auto&& visit) {
    visit("matches_per_keypoint", matches_per_keypoint,
          {1, 20, "Nearest model features of each scene keypoint."});
    visit("draws_per_match", draws_per_match,
          {1, 50, "Poses drawn by BPA from each correspondence."});
    visit("peaks_per_reference", peaks_per_reference,
          {1, 100, "Voted poses of each scene reference point."});
    visit(
        "rim_peaks_per_reference", rim_peaks_per_reference,
        {0, 100, "The same, voted by pairs with the rim of its face; 0: such pairs are not used."});
    visit("use_colors", use_colors,
          {0, 1, "Voted poses lay a reference point on a model point of agreeing colour."});
    visit("draws_per_prior", draws_per_prior, {0, 100000, "Poses drawn from each prior."});
    visit("feature_sigma_m", feature_sigma_m,
          {1e-4, 0.1,
           "Position error of a feature correspondence, metres: about the spacing of the "
           "features. Depth noise is added."});
    visit("pair_sigma_m", pair_sigma_m,
          {1e-4, 0.1, "Position error of a point pair's correspondence, metres."});
  }
  void visit_groups(auto&& visit) {
    visit("prior_alignment", prior_alignment, "Alignment of poses drawn from priors.");
  }
};

struct CheckOptions {
  int points = 64;
  int hidden_points = 512;
  int few_seen = 20;
  int min_seen = 6;
  double max_free_space = 0.2;
  double min_check_score = 0.15;
  double depth_share = 0.05;
  double min_depth_m = 0.006;
  double max_depth_m = 0.015;
  double free_depth_m = 0.030;
  double normal_cosine = 0.7;
  int recheck_points = 256;
  int rank_points = 24;
  int max_kept = 200;
  int max_ranked_per_cell = 2;
  int max_kept_per_cell = 1;
  double min_ranked_score = -8;
  int max_in_library = 800;
  double place_margin = 5;
  int max_suggested = 60;
  RefinementOptions correction{2, 64, 24, 0.020, 0.012};

  void visit_fields(auto&& visit) {
    visit("points", points,
          {1, 100000, "Model points that a pose is checked with. The paper has 500."});
    visit("hidden_points", hidden_points,
          {1, 100000, "At most so many, until few_seen are in sight."});
    visit("few_seen", few_seen,
          {0, 100000, "Points in sight below which hidden_points are checked."});
    visit("min_seen", min_seen, {0, 100000, "Poses with fewer points in sight are rejected."});
    visit("max_free_space", max_free_space,
          {0, 1, "Poses with a larger share of points in free space are rejected (V.3)."});
    visit("min_check_score", min_check_score,
          {-10, 10, "Poses with a lower check score are rejected."});
    visit("depth_share", depth_share,
          {0, 1, "Depth tolerance as a share of the model's diameter."});
    visit("min_depth_m", min_depth_m, {1e-4, 1, "Smallest depth tolerance, metres."});
    visit("max_depth_m", max_depth_m, {1e-4, 1, "Largest depth tolerance, metres."});
    visit("free_depth_m", free_depth_m,
          {1e-4, 1,
           "A point this far in front of the surface is in free space, metres. The paper "
           "has 0.05 (V.3)."});
    visit("normal_cosine", normal_cosine,
          {-1, 1, "Smallest cosine between the normals of model and surface."});
    visit("recheck_points", recheck_points,
          {1, 100000, "Model points of the second check, after the correction."});
    visit("rank_points", rank_points,
          {1, 100000, "Surface points of the round-two score that ranks the poses left."});
    visit("max_kept", max_kept, {1, 1000000, "Poses that go on."});
    visit("max_ranked_per_cell", max_ranked_per_cell,
          {1, 1000,
           "Poses in one cell of 25 mm and 25 degrees, the best by check score, that the round-two "
           "score ranks."});
    visit("max_kept_per_cell", max_kept_per_cell, {1, 1000, "Of these, poses that go on."});
    visit("min_ranked_score", min_ranked_score,
          {-1000, 1000, "Poses of lower log odds by rank_points are rejected."});
    visit("max_in_library", max_in_library,
          {1, 1000000, "Poses of all models together that go on."});
    visit("place_margin", place_margin,
          {0, 1000,
           "Poses are rejected where another in the same place, of any model, is better by more "
           "log odds."});
    visit("max_suggested", max_suggested,
          {0, 100000, "Poses drawn from priors that go on, beyond max_kept."});
  }
  void visit_groups(auto&& visit) {
    visit("correction", correction, "First small alignment of what passed the check.");
  }
};

struct ClusterOptions {
  int min_features = 2;
  int max_correspondences = 10;
  int rank_points = 64;
  int max_clusters = 60;
  double min_cluster_score = -7;
  int max_in_library = 180;
  double place_margin = 4;
  double suggested_share = 0.25;

  void visit_fields(auto&& visit) {
    visit("min_features", min_features,
          {1, 100,
           "Clusters with fewer feature correspondences are rejected (V.3). A voted pose "
           "stands for many pairs and is kept alone."});
    visit("max_correspondences", max_correspondences,
          {1, 100, "Correspondences that a cluster is aligned with."});
    visit("rank_points", rank_points,
          {1, 100000, "Surface points of the round-two score that ranks clusters."});
    visit("max_clusters", max_clusters,
          {1, 10000, "Clusters of one model that go on to round two."});
    visit("min_cluster_score", min_cluster_score,
          {-1000, 1000, "Clusters of lower log odds are rejected."});
    visit("max_in_library", max_in_library,
          {1, 1000000, "Clusters of all models together that go on."});
    visit("place_margin", place_margin,
          {0, 1000,
           "Poses are rejected where another in the same place, of any model, is better by more "
           "log odds."});
    visit("suggested_share", suggested_share,
          {0, 1, "Share of max_clusters kept for poses drawn from priors."});
  }
};

struct RoundTwoOptions {
  int bpa_steps = 3;
  int max_pairs = 12;
  int min_pairs = 4;
  double segment_share = 0.7;
  double start_gate_m = 0.030;
  double gate_decay = 0.8;
  int check_points = 300;
  double place_margin = 3;
  CheckTolerance tolerance{0.008, 0.020, 0.8};
  RefinementOptions refinement{4, 160, 60, 0.025, 0.012};

  void visit_fields(auto&& visit) {
    visit("bpa_steps", bpa_steps, {0, 100, "Alignments by BPA that are proposed (V.6)."});
    visit("max_pairs", max_pairs,
          {4, 1000, "Surface correspondences of one alignment; half as many of edges."});
    visit("min_pairs", min_pairs, {3, 1000, "With fewer correspondences the pose stays."});
    visit("segment_share", segment_share,
          {0, 1, "Share of the super-pixels that one alignment uses."});
    visit("start_gate_m", start_gate_m,
          {1e-4, 1, "Largest distance of correspondences in the first step, metres."});
    visit("gate_decay", gate_decay, {0.01, 1, "Factor of the gate from step to step."});
    visit("check_points", check_points,
          {1, 100000, "Model points that proposals are compared with."});
    visit("place_margin", place_margin,
          {0, 1000,
           "Poses are rejected where another in the same place, of any model, is better by more "
           "log odds."});
  }
  void visit_groups(auto&& visit) {
    visit("tolerance", tolerance, "How proposals are compared.");
    visit("refinement", refinement, "The last proposal.");
  }
};

struct RefineOptions {
  int max_refined = 30;
  double min_aligned_score = -7, min_refined_score = -5.5;
  int max_in_library = 60;
  double place_margin = 1;
  RefinementOptions refinement{8, 500, 60, 0.015, 0.008};

  void visit_fields(auto&& visit) {
    visit("max_refined", max_refined,
          {1, 10000, "Placements of one model that are aligned to the end."});
    visit("min_aligned_score", min_aligned_score,
          {-1000, 1000, "Placements of lower log odds are not aligned."});
    visit("min_refined_score", min_refined_score,
          {-1000, 1000, "Placements of lower log odds after alignment are not scored in full."});
    visit("max_in_library", max_in_library,
          {1, 1000000, "Placements of all models together that are aligned and scored in full."});
    visit("place_margin", place_margin,
          {0, 1000,
           "Poses are rejected where another in the same place, of any model, is better by more "
           "log odds."});
  }
  void visit_groups(auto&& visit) {
    visit("refinement", refinement, "Gradient-based alignment (V.7).");
  }
};

struct ClimbOptions {
  int max_climbed = 3;
  double min_climbed_score = -6;
  int rounds = 4;
  double step_m = 0.006;
  double beside_rad = 0.17;
  RefinementOptions refinement{6, 200, 60, 0.020, 0.008};

  void visit_fields(auto&& visit) {
    visit("max_climbed", max_climbed, {0, 10000, "Best placements that climb the score; 0: none."});
    visit("min_climbed_score", min_climbed_score,
          {-1000, 1000, "Placements of lower log odds do not climb."});
    visit("rounds", rounds, {0, 100, "Rounds of twelve steps each."});
    visit("step_m", step_m, {1e-5, 0.1, "First step at the object's rim, metres."});
    visit("beside_rad", beside_rad, {0, 3.2, "Turn of the six poses beside the start, radians."});
  }
  void visit_groups(auto&& visit) {
    visit("refinement", refinement, "Alignment from beside the start.");
  }
};

struct TurnOptions {
  int max_turned = 12;
  int max_kept_turned = 72;
  double min_turned_score = -5;

  void visit_fields(auto&& visit) {
    visit("max_turned", max_turned,
          {0, 10000, "Best placements that are tried in near-symmetric poses; 0: none."});
    visit("max_kept_turned", max_kept_turned,
          {0, 10000, "Near-symmetric poses that are aligned to the end."});
    visit("min_turned_score", min_turned_score,
          {-1000, 1000, "Placements of lower log odds are not turned."});
  }
};

struct FlatOptions {
  int max_laid = 4;
  int max_per_region = 4;
  double min_laid_score = -8;
  int slide_rounds = 5;
  double slide_step_m = 0.008;

  void visit_fields(auto&& visit) {
    visit("max_laid", max_laid,
          {0, 10000, "Poses at rest on flat regions that are scored in full; 0: none."});
    visit("max_per_region", max_per_region, {1, 10000, "The same of one region."});
    visit("min_laid_score", min_laid_score,
          {-1000, 1000, "Poses of lower log odds are neither moved nor scored in full."});
    visit("slide_rounds", slide_rounds, {0, 100, "Rounds of six steps each, on the plane."});
    visit("slide_step_m", slide_step_m, {1e-5, 0.1, "First step at the object's rim, metres."});
  }
};

struct RivalOptions {
  double max_behind = 6;
  double contender_margin = 3;
  double min_rival_score = -5;

  void visit_fields(auto&& visit) {
    visit("max_behind", max_behind,
          {0, 1000, "Placements this far behind the best in log odds are no rivals."});
    visit("contender_margin", contender_margin,
          {0, 1000,
           "Placements this far behind the best in log odds do not make others less likely."});
    visit("min_rival_score", min_rival_score,
          {-1000, 1000, "Places whose best has lower log odds are not compared."});
  }
};

struct SelectOptions {
  double min_score = -12;
  int max_placements = 50;
  double duplicate_m = 0.008;
  double duplicate_rad = 0.05;

  void visit_fields(auto&& visit) {
    visit("min_score", min_score, {-1e9, 1e9, "Placements of lower log odds are rejected."});
    visit("max_placements", max_placements,
          {1, 10000, "Placements of one model that are returned (section VI)."});
    visit("duplicate_m", duplicate_m,
          {0, 1, "Non-maximum suppression: largest distance of duplicates, metres."});
    visit("duplicate_rad", duplicate_rad,
          {0, 3.2, "Non-maximum suppression: largest turn of duplicates, radians."});
  }
};

struct ScoreOptions {
  bool use_round_three = true;
  bool stop_early = true;
  int quick_points = 200;
  double color_points = 2;

  void visit_fields(auto&& visit) {
    visit("use_round_three", use_round_three,
          {0, 1,
           "Score with edges, random walks, segments, features, colours and rivals; false "
           "leaves these components unknown."});
    visit("stop_early", stop_early,
          {0, 1, "Reject a placement as soon as its first score components make it improbable."});
    visit("quick_points", quick_points,
          {1, 100000, "Surface points that round two scores a placement with."});
    visit("color_points", color_points,
          {0, 100,
           "Independent points that the colours of a placement count as in quick scores; 0: "
           "colours do not count there."});
  }
};

/// The search for one object.
struct DetectOptions {
  AlignOptions align;
  ScoreOptions score;
  SampleOptions sample;
  CheckOptions check;
  ClusterOptions cluster;
  RoundTwoOptions round_two;
  RefineOptions refine;
  ClimbOptions climb;
  TurnOptions turn;
  FlatOptions flat;
  RivalOptions rivals;
  SelectOptions select;

  void visit_groups(auto&& visit) {
    visit("align", align, "What alignments use.");
    visit("score", score, "What placements are scored with.");
    visit("sample", sample, "Poses from features, point pairs and priors.");
    visit("check", check, "Free space.");
    visit("cluster", cluster, "Groups of poses.");
    visit("round_two", round_two, "Alignment to sampled segments.");
    visit("refine", refine, "Alignment to the end.");
    visit("climb", climb, "Hill climbing of the score.");
    visit("turn", turn, "Near symmetries.");
    visit("flat", flat, "Thin objects at rest on a plane.");
    visit("rivals", rivals, "Poses of one object in one place.");
    visit("select", select, "What is returned.");
  }
};

}  // namespace bpa
