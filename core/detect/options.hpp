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
  BPA_OPTION(int, iterations, 6, (0, 100), "Gauss-Newton steps.");
  BPA_OPTION(int, max_points, 200, (1, 100000), "Surface points of the model used.");
  BPA_OPTION(int, max_edges, 60, (0, 100000), "Edge points of the model used; 0: surface alone.");
  BPA_OPTION(double, start_gate_m, 0.030, (1e-4, 1),
             "Largest distance of correspondences in the first step, metres.");
  BPA_OPTION(double, end_gate_m, 0.010, (1e-4, 1),
             "Largest distance of correspondences in the last step, metres.");
};

constexpr char kPlaceMargin[] =
    "Poses are rejected where another in the same place, of any model, is better by more log odds.";

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
  BPA_OPTION(int, peaks_per_reference, 2, (1, 100), "Voted poses of each scene reference point.");
  BPA_OPTION(int, rim_peaks_per_reference, 1, (0, 100),
             "The same, voted by pairs with the rim of its face; 0: such pairs are not used.");
  BPA_OPTION(bool, use_colors, true, (),
             "Voted poses lay a reference point on a model point of agreeing colour.");
  BPA_OPTION(int, draws_per_prior, 300, (0, 100000), "Poses drawn from each prior.");
  BPA_OPTION(double, feature_sigma_m, 0.004, (1e-4, 0.1),
             "Position error of a feature correspondence, metres: about the spacing of the "
             "features. Depth noise is added.");
  BPA_OPTION(double, pair_sigma_m, 0.008, (1e-4, 0.1),
             "Position error of a point pair's correspondence, metres.");
  BPA_GROUP(RefinementOptions, prior_alignment, "Alignment of poses drawn from priors.") = {
      4, 100, 30, 0.050, 0.015};
};

struct CheckOptions {
  BPA_OPTION(int, points, 64, (1, 100000),
             "Model points that a pose is checked with. The paper has 500.");
  BPA_OPTION(int, hidden_points, 512, (1, 100000), "At most so many, until few_seen are in sight.");
  BPA_OPTION(int, few_seen, 20, (0, 100000),
             "Points in sight below which hidden_points are checked.");
  BPA_OPTION(int, min_seen, 6, (0, 100000), "Poses with fewer points in sight are rejected.");
  BPA_OPTION(double, max_free_space, 0.2, (0, 1),
             "Poses with a larger share of points in free space are rejected (V.3).");
  BPA_OPTION(double, min_check_score, 0.15, (-10, 10),
             "Poses with a lower check score are rejected.");
  BPA_OPTION(double, depth_share, 0.05, (0, 1),
             "Depth tolerance as a share of the model's diameter.");
  BPA_OPTION(double, min_depth_m, 0.006, (1e-4, 1), "Smallest depth tolerance, metres.");
  BPA_OPTION(double, max_depth_m, 0.015, (1e-4, 1), "Largest depth tolerance, metres.");
  BPA_OPTION(double, free_depth_m, 0.030, (1e-4, 1),
             "A point this far in front of the surface is in free space, metres. The paper has "
             "0.05 (V.3).");
  BPA_OPTION(double, normal_cosine, 0.7, (-1, 1),
             "Smallest cosine between the normals of model and surface.");
  BPA_OPTION(int, recheck_points, 256, (1, 100000),
             "Model points of the second check, after the correction.");
  BPA_OPTION(int, rank_points, 24, (1, 100000),
             "Surface points of the round-two score that ranks the poses left.");
  BPA_OPTION(int, max_kept, 200, (1, 1000000), "Poses that go on.");
  BPA_OPTION(int, max_ranked_per_cell, 2, (1, 1000),
             "Poses in one cell of 25 mm and 25 degrees, the best by check score, that the "
             "round-two score ranks.");
  BPA_OPTION(int, max_kept_per_cell, 1, (1, 1000), "Of these, poses that go on.");
  BPA_OPTION(double, min_ranked_score, -8, (-1000, 1000),
             "Poses of lower log odds by rank_points are rejected.");
  BPA_OPTION(int, max_in_library, 800, (1, 1000000), "Poses of all models together that go on.");
  BPA_OPTION(double, place_margin, 5, (0, 1000), kPlaceMargin);
  BPA_OPTION(int, max_suggested, 60, (0, 100000),
             "Poses drawn from priors that go on, beyond max_kept.");
  BPA_GROUP(RefinementOptions, correction, "First small alignment of what passed the check.") = {
      2, 64, 24, 0.020, 0.012};
};

struct ClusterOptions {
  BPA_OPTION(int, min_features, 2, (1, 100),
             "Clusters with fewer feature correspondences are rejected (V.3). A voted pose stands "
             "for many pairs and is kept alone.");
  BPA_OPTION(int, max_correspondences, 10, (1, 100),
             "Correspondences that a cluster is aligned with.");
  BPA_OPTION(int, rank_points, 64, (1, 100000),
             "Surface points of the round-two score that ranks clusters.");
  BPA_OPTION(int, max_clusters, 60, (1, 10000), "Clusters of one model that go on to round two.");
  BPA_OPTION(double, min_cluster_score, -7, (-1000, 1000),
             "Clusters of lower log odds are rejected.");
  BPA_OPTION(int, max_in_library, 180, (1, 1000000), "Clusters of all models together that go on.");
  BPA_OPTION(double, place_margin, 4, (0, 1000), kPlaceMargin);
  BPA_OPTION(double, suggested_share, 0.25, (0, 1),
             "Share of max_clusters kept for poses drawn from priors.");
};

struct RoundTwoOptions {
  BPA_OPTION(int, bpa_steps, 3, (0, 100), "Alignments by BPA that are proposed (V.6).");
  BPA_OPTION(int, max_pairs, 12, (4, 1000),
             "Surface correspondences of one alignment; half as many of edges.");
  BPA_OPTION(int, min_pairs, 4, (3, 1000), "With fewer correspondences the pose stays.");
  BPA_OPTION(double, segment_share, 0.7, (0, 1),
             "Share of the super-pixels that one alignment uses.");
  BPA_OPTION(double, start_gate_m, 0.030, (1e-4, 1),
             "Largest distance of correspondences in the first step, metres.");
  BPA_OPTION(double, gate_decay, 0.8, (0.01, 1), "Factor of the gate from step to step.");
  BPA_OPTION(int, check_points, 300, (1, 100000), "Model points that proposals are compared with.");
  BPA_OPTION(double, place_margin, 3, (0, 1000), kPlaceMargin);
  BPA_GROUP(CheckTolerance, tolerance, "How proposals are compared.") = {0.008, 0.020, 0.8};
  BPA_GROUP(RefinementOptions, refinement, "The last proposal.") = {4, 160, 60, 0.025, 0.012};
};

struct RefineOptions {
  BPA_OPTION(int, max_refined, 30, (1, 10000),
             "Placements of one model that are aligned to the end.");
  BPA_OPTION(double, min_aligned_score, -7, (-1000, 1000),
             "Placements of lower log odds are not aligned.");
  BPA_OPTION(double, min_refined_score, -5.5, (-1000, 1000),
             "Placements of lower log odds after alignment are not scored in full.");
  BPA_OPTION(int, max_in_library, 60, (1, 1000000),
             "Placements of all models together that are aligned and scored in full.");
  BPA_OPTION(double, place_margin, 1, (0, 1000), kPlaceMargin);
  BPA_GROUP(RefinementOptions, refinement, "Gradient-based alignment (V.7).") = {8, 500, 60, 0.015,
                                                                                 0.008};
};

struct ClimbOptions {
  BPA_OPTION(int, max_climbed, 3, (0, 10000), "Best placements that climb the score; 0: none.");
  BPA_OPTION(double, min_climbed_score, -6, (-1000, 1000),
             "Placements of lower log odds do not climb.");
  BPA_OPTION(int, rounds, 4, (0, 100), "Rounds of twelve steps each.");
  BPA_OPTION(double, step_m, 0.006, (1e-5, 0.1), "First step at the object's rim, metres.");
  BPA_OPTION(double, beside_rad, 0.17, (0, 3.2),
             "Turn of the six poses beside the start, radians.");
  BPA_GROUP(RefinementOptions, refinement, "Alignment from beside the start.") = {6, 200, 60, 0.020,
                                                                                  0.008};
};

struct TurnOptions {
  BPA_OPTION(int, max_turned, 12, (0, 10000),
             "Best placements that are tried in near-symmetric poses; 0: none.");
  BPA_OPTION(int, max_kept_turned, 72, (0, 10000),
             "Near-symmetric poses that are aligned to the end.");
  BPA_OPTION(double, min_turned_score, -5, (-1000, 1000),
             "Placements of lower log odds are not turned.");
};

struct FlatOptions {
  BPA_OPTION(int, max_laid, 4, (0, 10000),
             "Poses at rest on flat regions that are scored in full; 0: none.");
  BPA_OPTION(int, max_per_region, 4, (1, 10000), "The same of one region.");
  BPA_OPTION(double, min_laid_score, -8, (-1000, 1000),
             "Poses of lower log odds are neither moved nor scored in full.");
  BPA_OPTION(int, slide_rounds, 5, (0, 100), "Rounds of six steps each, on the plane.");
  BPA_OPTION(double, slide_step_m, 0.008, (1e-5, 0.1), "First step at the object's rim, metres.");
};

struct RivalOptions {
  BPA_OPTION(double, max_behind, 6, (0, 1000),
             "Placements this far behind the best in log odds are no rivals.");
  BPA_OPTION(double, contender_margin, 3, (0, 1000),
             "Placements this far behind the best in log odds do not make others less likely.");
  BPA_OPTION(double, min_rival_score, -5, (-1000, 1000),
             "Places whose best has lower log odds are not compared.");
};

struct SelectOptions {
  BPA_OPTION(double, min_score, -12, (-1e9, 1e9), "Placements of lower log odds are rejected.");
  BPA_OPTION(int, max_placements, 50, (1, 10000),
             "Placements of one model that are returned (section VI).");
  BPA_OPTION(double, duplicate_m, 0.008, (0, 1),
             "Non-maximum suppression: largest distance of duplicates, metres.");
  BPA_OPTION(double, duplicate_rad, 0.05, (0, 3.2),
             "Non-maximum suppression: largest turn of duplicates, radians.");
};

struct ScoreOptions {
  BPA_OPTION(bool, use_round_three, true, (),
             "Score with edges, random walks, segments, features, colours and rivals; false leaves "
             "these components unknown.");
  BPA_OPTION(bool, stop_early, true, (),
             "Reject a placement as soon as its first score components make it improbable.");
  BPA_OPTION(int, quick_points, 200, (1, 100000),
             "Surface points that round two scores a placement with.");
  BPA_OPTION(double, color_points, 2, (0, 100),
             "Independent points that the colours of a placement count as in quick scores; 0: "
             "colours do not count there.");
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
  BPA_GROUP(FlatOptions, flat, "Thin objects at rest on a plane.");
  BPA_GROUP(RivalOptions, rivals, "Poses of one object in one place.");
  BPA_GROUP(SelectOptions, select, "What is returned.");
};

}  // namespace bpa
