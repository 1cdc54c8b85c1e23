// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/options.hpp"
#include "core/base/status.hpp"
#include "core/eval/covariance_error.hpp"
#include "core/eval/pose_errors.hpp"
#include "core/io/results.hpp"

namespace bpa::eval {

/// The tolerances of a right placement, and which instances count. Paper, section VII: 2.5 cm and
/// π/16 "with respect to the model's symmetry group" on Clutter, RMSE 1 cm on Kinect.
struct EvaluationOptions {
  BPA_OPTION(double, position_m, kPoseTolerance_m, (0.001, 1),
             "Largest position error of a match, metres.");
  BPA_OPTION(double, angle_rad, kPoseTolerance_rad, (0.001, 3.2),
             "Largest angle error of a match, radians.");
  BPA_OPTION(double, rmse_m, 0.01, (0.001, 1), "Largest RMSE of a match, metres.");
  BPA_OPTION(double, min_visible_fraction, 0.1, (0, 1),
             "Less visible instances are neither required nor false positives.");
  BPA_OPTION(bool, bop_errors, true, (0, 1), "Also compute ADD, VSD, MSSD and MSPD.");
  BPA_OPTION(int, num_threads, 0, (0, 256), "0 = one per core.");
};

/// An object with the mesh that errors are measured on.
struct EvalObject {
  std::string name;
  double diameter = 0;
  SymmetryGroup symmetry;
  TriangleMesh mesh;
};

/// By obj_id.
using EvalObjects = std::map<int, EvalObject>;

/// The objects of a BOP data set, meshes in metres.
Result<EvalObjects> load_eval_objects(const std::string& dataset);

/// Counts behind a precision or recall.
struct Ratio {
  int hits = 0;
  int total = 0;

  double value() const { return total > 0 ? static_cast<double>(hits) / total : 0.0; }
};

/// One of the poses that a placement leaves open.
struct PoseOutcome {
  double weight = 0;
  bool right = false;
};

/// Everything known about one placement of the best interpretation.
struct EstimateOutcome {
  int obj_id = 0;
  double probability = 0;
  double distance = 0;   ///< Of the estimate from the camera, metres.
  int truth = -1;        ///< Index of the instance it is right about (of its frame's truth), or -1.
  bool ignored = false;  ///< Right about an instance that does not count.
  bool present = false;  ///< An instance of the object is at most 5 cm away.
  std::optional<CovarianceError> covariance_error;  ///< Of a right one.
  /// Its own pose and its alternatives, against the nearest instance of the same object, at most 5
  /// cm away; empty without alternatives or without such an instance.
  std::vector<PoseOutcome> poses;
};

/// Everything known about one true instance.
struct TruthOutcome {
  int obj_id = 0;
  double visible_fraction = 0;
  double distance = 0;
  bool counts = true;
  bool found = false;       ///< By the best interpretation.
  bool found_rmse = false;  ///< By it, with the RMSE criterion.
  int found_at_rank = 0;    ///< The first interpretation that finds it, from 1; 0 = none.
  /// The same where an alternative of a placement finds it as well as the placement's own pose.
  int among_alternatives_at_rank = 0;
  double add = -1;  ///< Of the estimate that found it, metres; -1 when not found.
  double adds = -1;
};

struct FrameOutcome {
  int scene_id = 0;
  int im_id = 0;
  double seconds = 0;
  bool reported = false;  ///< Whether the results have this frame.
  std::vector<EstimateOutcome> estimates;
  std::vector<TruthOutcome> truth;
  int rmse_correct = 0;
  int rmse_reported = 0;
  /// BOP: matched truths for each threshold of correctness; VSD for each tolerance and threshold.
  std::array<int, 10> mssd{};
  std::array<int, 10> mspd{};
  std::array<std::array<int, 10>, 10> vsd{};
  int add_correct = 0;  ///< Truths matched with ADD (ADD-S when symmetric) under 0.1 diameters.
};

/// A row of a break-down.
struct Group {
  std::string name;
  Ratio recall;
  Ratio precision;  ///< total 0 where it has no meaning (by visible fraction).
};

struct ReliabilityBin {
  double low = 0;
  double high = 0;
  double mean_probability = 0;
  Ratio correct;
};

/// What remains of the best interpretations if less probable placements are left out.
struct ThresholdPoint {
  double threshold = 0;  ///< Least probability of a placement, in [0, 1].
  Ratio precision;       ///< Of the placements that remain.
  Ratio recall;          ///< Instances that the remaining placements find.
  double false_positives_per_frame = 0;
};

struct Coverage {
  double level = 0;  ///< The credible region's, such as 0.95.
  Ratio covered;
};

/// Placements that leave several poses open, of objects that are there.
struct OpenPoses {
  Ratio own;   ///< The placement's own pose is right.
  Ratio held;  ///< It or one of its alternatives is.
  std::vector<ReliabilityBin> weights;
};

/// What was reported in frames where nothing that counts is to be found.
struct FalseReports {
  int free_frames = 0;         ///< Such frames.
  int frames_with_report = 0;  ///< Of them, those with a report.
  int reports = 0;
};

struct TimeStatistics {
  int frames = 0;
  double mean = 0, median = 0, max = 0;  ///< Seconds.
};

struct EvaluationReport {
  int frames = 0;
  Ratio precision, recall;            ///< Paper: 2.5 cm, π/16.
  Ratio present;                      ///< Placements whose object is there, at whatever pose.
  Ratio rmse_precision, rmse_recall;  ///< Paper: RMSE 1 cm.
  std::map<int, Ratio> recall_at;     ///< By number of interpretations: 1, 2, 3, 5, 10, 20.
  /// Instances whose pose is that of a placement or of one of its alternatives, by the same
  /// numbers.
  std::map<int, Ratio> among_alternatives_at;
  bool has_bop = false;
  Ratio add_recall;
  double vsd = 0, mssd = 0, mspd = 0, average_recall = 0;  ///< BOP's average recalls.
  double mean_add = 0, mean_adds = 0;                      ///< Of what was found, metres.
  std::vector<Group> by_object, by_visible_fraction, by_distance;
  double brier = 0;
  /// Mean over placements of |mean probability - fraction right| of their tenth (Naeini et al.
  /// 2015).
  double expected_calibration_error = 0;
  std::vector<ReliabilityBin> reliability;
  std::vector<ThresholdPoint> threshold_curve;  ///< At 0.05, 0.10, ..., 0.95.
  std::vector<Coverage> coverage;               ///< Of right placements with a covariance.
  /// Mean squared error over the covariance, for each degree of freedom: below 1 it is too large.
  double normalised_square = 0;
  OpenPoses open_poses;
  FalseReports false_reports;
  std::array<int, 10> visible_tenths{};  ///< All instances by visible fraction.
  double median_visible_fraction = 0;
  TimeStatistics time;
  std::vector<FrameOutcome> outcomes;
  std::vector<std::string> left_out;  ///< Frames whose depth cannot be read: why. Nothing counts.
};

/// Precision and recall at each threshold, ascending, from what is known of each frame. A result
/// holds no placement below the detector's own scene.min_probability: there the curve is level.
std::vector<ThresholdPoint> threshold_curve(const std::vector<FrameOutcome>& frames);

/// 0 (the probabilities are the fractions) to 1; 0 without a placement.
double expected_calibration_error(const std::vector<ReliabilityBin>& bins);

/// The times of the reported frames whose time is known, ascending.
std::vector<double> sorted_seconds(const EvaluationReport& report);

/// Evaluates one frame. `result` may be null: nothing was reported.
Result<FrameOutcome> evaluate_frame(const io::BopFrame& frame, const EvalObjects& objects,
                                    const io::FrameResult* result,
                                    const EvaluationOptions& options);

/// Called after each frame with the number of frames done, from one thread at a time.
using EvaluationProgress = std::function<void(int)>;

/// Compares results with the truth of `frames`. A frame without a result counts as an empty result.
/// Fails with invalid_argument when a result names an unknown frame or object, or a frame has no
/// truth. Frames whose depth cannot be read, which VSD needs, are `left_out`.
Result<EvaluationReport> evaluate(const std::vector<io::BopFrame>& frames,
                                  const EvalObjects& objects,
                                  const std::vector<io::FrameResult>& results,
                                  const EvaluationOptions& options = {},
                                  const EvaluationProgress& progress = {});

/// Judges results of frames that hold no known object: every placement is a false positive.
Result<EvaluationReport> evaluate_nothing_there(const std::vector<io::FrameResult>& results,
                                                const EvaluationOptions& options = {});

/// The report as tables for people.
std::string report_text(const EvaluationReport& report);

/// The report as JSON; every ratio with its counts.
std::string report_json(const EvaluationReport& report);

}  // namespace bpa::eval
