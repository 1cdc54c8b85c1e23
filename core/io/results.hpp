// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/geometry/pose.hpp"

// What detection reports, as files hold it. The CSV is the BOP benchmark's (scene_id, im_id,
// obj_id, score, R, t, time; millimetres) and holds the best interpretation; our JSON holds all of
// them.

namespace bpa::io {

/// A pose and its weight among the alternatives of a placement.
struct ResultAlternative {
  Pose camera_from_object;
  double weight = 0;
};

struct ResultComponent {
  std::string name;
  double value = 0;
};

/// One object; the fields mean what those of Placement do.
struct ResultPlacement {
  int obj_id = 0;
  std::string model;  ///< Empty when read from a CSV.
  Pose camera_from_object;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 4, 3> orientation_axes = Eigen::Matrix<double, 4, 3>::Zero();
  Eigen::Vector3d orientation_concentrations = Eigen::Vector3d::Zero();
  double score = 0;
  double probability = 0;  ///< The CSV's score.
  double visible_fraction = 0;
  std::vector<ResultComponent> components;
  std::vector<ResultAlternative> alternatives;
};

struct ResultInterpretation {
  int rank = 1;
  double score = 0;
  double probability = 0;
  std::vector<ResultPlacement> placements;
};

struct ResultTiming {
  std::string stage;
  double milliseconds = 0;
};

struct FrameResult {
  int scene_id = 0;
  int im_id = 0;
  double seconds = 0;  ///< Spent on the whole frame.
  bool budget_exhausted = false;
  int fused_frames = 1;                               ///< How many frames its depth is made of.
  std::vector<ResultInterpretation> interpretations;  ///< Ranked.
  std::vector<ResultTiming> timings;
};

/// Writes the best interpretation of each frame; the score is the placement's probability.
Status write_results_csv(const std::string& path, const std::vector<FrameResult>& results);

/// One interpretation a frame, frames by (scene_id, im_id). A frame in which nothing was found does
/// not appear in a CSV at all. Scores outside [0, 1] are kept as they are. Fails with corrupt
/// naming file, line and column.
Result<std::vector<FrameResult>> read_results_csv(const std::string& path);

/// Everything; numbers survive to the last bit.
Status write_results_json(const std::string& path, const std::vector<FrameResult>& results);
Result<std::vector<FrameResult>> read_results_json(const std::string& path);

}  // namespace bpa::io
