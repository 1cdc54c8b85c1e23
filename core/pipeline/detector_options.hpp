// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/options.hpp"

namespace bpa {

/// Every setting of the detector. The defaults are meant for a Kinect-class sensor and household
/// objects; config/detector.yaml lists them all.
struct DetectorOptions {
  double max_range_m = 2.5;
  double normal_radius_m = 0.010;
  bool label_planes = true;
  double plane_min_extent_m = 0.35;
  int max_keypoints = 600;
  int matches_per_keypoint = 2;
  int draws_per_match = 3;
  int max_references = 800;
  int peaks_per_reference = 12;
  int max_clusters = 200;
  int max_refined = 40;
  bool use_orientation = true;
  bool use_segments = true;
  bool use_edges = true;
  bool climb = true;
  bool use_round_three = true;
  bool use_color = true;
  double min_probability = 0.3;
  double object_penalty = 0.2;
  double explained_weight = 2;
  int annealing_steps = 20000;

  template <class Visitor>
  void visit_fields(Visitor&& visit) {
    visit("max_range_m", max_range_m,
          FieldRule{0.2, 20, "Surface further away than this is ignored, metres."});
    visit("normal_radius_m", normal_radius_m,
          FieldRule{0.003, 0.05, "Radius of the window a surface normal is fitted in, metres."});
    visit("label_planes", label_planes,
          FieldRule{0, 1, "Label large planes (table, wall) as background."});
    visit("plane_min_extent_m", plane_min_extent_m,
          FieldRule{0.1, 10, "Smaller planes may be faces of objects and are kept, metres."});
    visit("max_keypoints", max_keypoints,
          FieldRule{10, 100000, "Scene points whose features are matched with the models."});
    visit("matches_per_keypoint", matches_per_keypoint,
          FieldRule{1, 20, "Nearest model features tried for each of them."});
    visit("draws_per_match", draws_per_match,
          FieldRule{1, 50, "Poses drawn by BPA for each correspondence."});
    visit("max_references", max_references,
          FieldRule{0, 100000, "Scene points whose pairs with others vote for poses."});
    visit("peaks_per_reference", peaks_per_reference,
          FieldRule{1, 100, "Voted poses of each of them that are looked at."});
    visit("max_clusters", max_clusters,
          FieldRule{1, 10000, "Pose clusters of each model that go on to round two."});
    visit("max_refined", max_refined,
          FieldRule{1, 10000, "Placements of each model that are aligned to the end."});
    visit("use_orientation", use_orientation,
          FieldRule{0, 1, "Align with orientations (BPA); false aligns by positions only (ICP)."});
    // What experiments leave out, one at a time (tests/accuracy/leave_one_out.sh).
    visit("use_segments", use_segments,
          FieldRule{0, 1,
                    "Align to sampled super-pixels; false, for experiments, aligns to all "
                    "surface."});
    visit("use_edges", use_edges,
          FieldRule{0, 1, "Align edges with edges, too; false, for experiments, surface alone."});
    visit("climb", climb,
          FieldRule{0, 1,
                    "Let the best placements climb the score; false, for experiments, leaves them "
                    "where alignment ends."});
    visit("use_round_three", use_round_three,
          FieldRule{0, 1,
                    "Score with edges, random walks, segments, features and colours, too; false, "
                    "for experiments, leaves these components unknown."});
    visit("use_color", use_color,
          FieldRule{0, 1, "Use the frame's colours; false, for experiments, ignores them."});
    visit("min_probability", min_probability,
          FieldRule{0, 1,
                    "Placements less probable than this are not part of the best "
                    "interpretation."});
    visit("object_penalty", object_penalty,
          FieldRule{0, 100, "Log odds that each further object of an interpretation costs."});
    visit("explained_weight", explained_weight,
          FieldRule{0, 1000, "Weight of the ratio of explained to observed surface."});
    visit("annealing_steps", annealing_steps,
          FieldRule{0, 10000000, "Moves of the search for interpretations."});
  }
};

/// Reads a YAML file that overrides some defaults. Fails with not_found, or with invalid_argument
/// naming the file, the line, the key (unknown keys are errors), the value and the rule.
Result<DetectorOptions> load_detector_options(const std::string& path);

}  // namespace bpa
