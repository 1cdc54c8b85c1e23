// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/evaluation.hpp"

#include <algorithm>
#include <mutex>
#include <numeric>
#include <optional>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/io/mesh_file.hpp"

namespace bpa::eval {
namespace {

constexpr double kMetresPerMillimetre = 0.001;
constexpr int kRanks[] = {1, 2, 3, 5, 10, 20};
constexpr int kBins = 10;

std::string frame_name(int scene_id, int im_id) {
  return "scene " + std::to_string(scene_id) + " image " + std::to_string(im_id);
}

/// The result of each frame; null where there is none.
Result<std::vector<const io::FrameResult*>> assign(const std::vector<io::BopFrame>& frames,
                                                   const EvalObjects& objects,
                                                   const std::vector<io::FrameResult>& results) {
  std::map<std::pair<int, int>, std::size_t> index;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    index[{frames[i].scene_id, frames[i].im_id}] = i;
    if (!frames[i].has_truth) {
      return invalid_argument(frame_name(frames[i].scene_id, frames[i].im_id),
                              " has no truth (scene_gt.json); evaluation needs it");
    }
    for (const io::BopInstance& instance : frames[i].truth) {
      if (objects.count(instance.obj_id) == 0) {
        return invalid_argument("the truth of ", frame_name(frames[i].scene_id, frames[i].im_id),
                                " has obj_id ", instance.obj_id, ", which is not among the models");
      }
    }
  }
  std::vector<const io::FrameResult*> assigned(frames.size(), nullptr);
  for (const io::FrameResult& result : results) {
    const auto found = index.find({result.scene_id, result.im_id});
    if (found == index.end()) {
      return invalid_argument("the results have ", frame_name(result.scene_id, result.im_id),
                              ", which is not in the data set");
    }
    for (const Interpretation& interpretation : result.interpretations) {
      for (const Placement& placement : interpretation.placements) {
        if (objects.count(placement.model_number) == 0) {
          return invalid_argument("the results have obj_id ", placement.model_number,
                                  ", which is not among the data set's models");
        }
      }
    }
    assigned[found->second] = &result;
  }
  return assigned;
}

void count(Ratio& ratio, bool hit) {
  ratio.hits += hit;
  ++ratio.total;
}

/// Rows of equal width; the last one takes everything beyond.
struct Rows {
  double first, width;
  int count;
  const char* unit;
};

constexpr Rows kFractionRows{0.1, 0.1, 9, ""}, kDistanceRows{0.4, 0.2, 8, " m"};

std::vector<Group> groups_of(const Rows& rows) {
  std::vector<Group> groups;
  for (int i = 0; i < rows.count; ++i) {
    groups.emplace_back().name = format("%.1f-%.1f%s", rows.first + i * rows.width,
                                        rows.first + (i + 1) * rows.width, rows.unit);
  }
  return groups;
}

Group& group_of(std::vector<Group>& groups, const Rows& rows, double value) {
  const int row = static_cast<int>((value - rows.first) / rows.width + 1e-9);
  return groups[std::clamp(row, 0, rows.count - 1)];
}

std::vector<ReliabilityBin> empty_bins() {
  std::vector<ReliabilityBin> bins;
  for (double i = 0; i < kBins; ++i) bins.push_back({i / kBins, (i + 1) / kBins, 0, {}});
  return bins;
}

void add_to_bins(std::vector<ReliabilityBin>& bins, double probability, bool right) {
  ReliabilityBin& bin = bins[std::clamp(static_cast<int>(probability * kBins), 0, kBins - 1)];
  bin.mean_probability += probability;
  count(bin.correct, right);
}

void finish_bins(std::vector<ReliabilityBin>& bins) {
  for (ReliabilityBin& bin : bins) bin.mean_probability /= std::max(1, bin.correct.total);
}

/// A report in the making: its means are sums.
struct Draft {
  EvaluationReport report;
  std::map<int, Group> by_object;
  std::vector<double> visible_fractions;  ///< Of all instances.
  int with_covariance = 0;                ///< Placements behind normalised_square.
};

Draft empty_draft() {
  Draft draft;
  draft.report.by_visible_fraction = groups_of(kFractionRows);
  draft.report.by_distance = groups_of(kDistanceRows);
  draft.report.reliability = draft.report.open_poses.weights = empty_bins();
  for (const double level : kCredibleLevels) draft.report.coverage.push_back({level, {}});
  return draft;
}

void add_open_poses(const EstimateOutcome& estimate, OpenPoses& open) {
  if (estimate.poses.empty()) return;
  bool any = false;
  for (const PoseOutcome& pose : estimate.poses) {
    any = any || pose.right;
    add_to_bins(open.weights, pose.weight, pose.right);
  }
  count(open.held, any);
  count(open.own, estimate.poses.front().right);
}

/// A placement that counts.
void add_estimate(const EstimateOutcome& estimate, Draft& draft) {
  EvaluationReport& report = draft.report;
  const bool right = estimate.truth >= 0;
  const double p = std::clamp(estimate.probability, 0.0, 1.0);
  count(report.precision, right);
  count(report.present, estimate.present);
  count(draft.by_object[estimate.obj_id].precision, right);
  count(group_of(report.by_distance, kDistanceRows, estimate.distance).precision, right);
  report.brier += (p - right) * (p - right);
  add_to_bins(report.reliability, p, right);
  if (!right || !estimate.covariance_error) return;
  const auto [squared, degrees_of_freedom] = *estimate.covariance_error;
  ++draft.with_covariance;
  report.normalised_square += squared / degrees_of_freedom;
  for (std::size_t i = 0; i < std::size(kCredibleLevels); ++i) {
    const double quantile = chi_squared_quantile(static_cast<int>(i), degrees_of_freedom);
    count(report.coverage[i].covered, squared <= quantile);
  }
}

/// An instance that counts.
void add_truth(const TruthOutcome& truth, Draft& draft) {
  EvaluationReport& report = draft.report;
  count(report.recall, truth.found);
  count(report.rmse_recall, truth.found_rmse);
  for (const int rank : kRanks) {
    const auto by_then = [rank](int found_at) { return found_at > 0 && found_at <= rank; };
    count(report.recall_at[rank], by_then(truth.found_at_rank));
    count(report.among_alternatives_at[rank], by_then(truth.among_alternatives_at_rank));
  }
  count(draft.by_object[truth.obj_id].recall, truth.found);
  count(group_of(report.by_visible_fraction, kFractionRows, truth.visible_fraction).recall,
        truth.found);
  count(group_of(report.by_distance, kDistanceRows, truth.distance).recall, truth.found);
  if (!truth.found) return;
  report.mean_add += truth.add;
  report.mean_adds += truth.adds;
}

void add_frame(const FrameOutcome& frame, Draft& draft) {
  EvaluationReport& report = draft.report;
  int reports = 0;
  for (const EstimateOutcome& estimate : frame.estimates) {
    add_open_poses(estimate, report.open_poses);
    if (estimate.ignored) continue;
    ++reports;
    add_estimate(estimate, draft);
  }
  bool free = true;
  for (const TruthOutcome& truth : frame.truth) {
    draft.visible_fractions.push_back(truth.visible_fraction);
    const int tenth = static_cast<int>(10 * truth.visible_fraction + 1e-9);
    ++report.visible_tenths[std::clamp(tenth, 0, 9)];
    if (!truth.counts) continue;
    free = false;
    add_truth(truth, draft);
  }
  report.rmse_precision.hits += frame.rmse_correct;
  report.rmse_precision.total += frame.rmse_reported;
  if (!free) return;
  ++report.false_reports.free_frames;
  report.false_reports.frames_with_report += reports > 0;
  report.false_reports.reports += reports;
}

/// The middle value; of an even number of them, the mean of the middle two; 0 of none.
double median(const std::vector<double>& sorted) {
  const std::size_t n = sorted.size();
  return n > 0 ? 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]) : 0;
}

/// Turns sums into means.
EvaluationReport finished(Draft draft, const EvalObjects& objects) {
  EvaluationReport& report = draft.report;
  report.mean_add /= std::max(1, report.recall.hits);
  report.mean_adds /= std::max(1, report.recall.hits);
  report.brier /= std::max(1, report.precision.total);
  report.normalised_square /= std::max(1, draft.with_covariance);
  finish_bins(report.reliability);
  finish_bins(report.open_poses.weights);
  report.expected_calibration_error = expected_calibration_error(report.reliability);
  report.threshold_curve = threshold_curve(report.outcomes);
  for (auto& [obj_id, group] : draft.by_object) {
    group.name = objects.at(obj_id).name;
    report.by_object.push_back(group);
  }
  const auto empty = [](const Group& g) { return g.recall.total + g.precision.total == 0; };
  std::erase_if(report.by_visible_fraction, empty);
  std::erase_if(report.by_distance, empty);
  std::ranges::sort(draft.visible_fractions);
  report.median_visible_fraction = median(draft.visible_fractions);
  return std::move(report);
}

void add_time(EvaluationReport& report) {
  const std::vector<double> seconds = sorted_seconds(report);
  if (seconds.empty()) return;
  const double sum = std::accumulate(seconds.begin(), seconds.end(), 0.0);
  const int frames = static_cast<int>(seconds.size());
  report.time = {frames, sum / frames, median(seconds), seconds.back()};
}

void add_bop(EvaluationReport& report) {
  report.has_bop = true;
  const auto sum = [](const auto& counts) {
    return std::accumulate(counts.begin(), counts.end(), 0.0);
  };
  for (const FrameOutcome& frame : report.outcomes) {
    report.add_recall.hits += frame.add_correct;
    report.mssd += sum(frame.mssd);
    report.mspd += sum(frame.mspd);
    for (const auto& row : frame.vsd) report.vsd += sum(row);
  }
  report.add_recall.total = report.recall.total;
  if (report.recall.total == 0) return;
  report.vsd /= 100.0 * report.recall.total;
  report.mssd /= 10.0 * report.recall.total;
  report.mspd /= 10.0 * report.recall.total;
  report.average_recall = (report.vsd + report.mssd + report.mspd) / 3;
}

}  // namespace

Result<EvalObjects> load_eval_objects(const std::string& dataset) {
  const Result<std::vector<io::BopModel>> models = io::read_bop_models(dataset);
  if (!models.ok()) return models.status();
  EvalObjects objects;
  for (const io::BopModel& model : *models) {
    Result<TriangleMesh> mesh = io::read_mesh(model.path, kMetresPerMillimetre);
    if (!mesh.ok()) return mesh.status();
    objects[model.obj_id] = {model.name, model.diameter, model.symmetry, std::move(*mesh)};
  }
  return objects;
}

std::vector<double> sorted_seconds(const EvaluationReport& report) {
  std::vector<double> seconds;
  for (const FrameOutcome& frame : report.outcomes) {
    if (frame.reported && frame.seconds >= 0) seconds.push_back(frame.seconds);  // BOP: -1 unknown
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds;
}

Result<EvaluationReport> evaluate(const std::vector<io::BopFrame>& frames,
                                  const EvalObjects& objects,
                                  const std::vector<io::FrameResult>& results,
                                  const EvaluationOptions& options,
                                  const EvaluationProgress& progress) {
  if (Status status = validate(options); !status.ok()) return status;
  const auto assigned = assign(frames, objects, results);
  if (!assigned.ok()) return assigned.status();
  std::vector<std::optional<Result<FrameOutcome>>> outcomes(frames.size());
  std::mutex mutex;
  int done = 0;
  parallel_for(frames.size(), options.num_threads, [&](std::size_t i) {
    outcomes[i] = evaluate_frame(frames[i], objects, (*assigned)[i], options);
    const std::lock_guard lock(mutex);
    ++done;
    if (progress) progress(done);
  });
  Draft draft = empty_draft();
  for (auto& outcome : outcomes) {
    if (!outcome->ok()) {
      draft.report.left_out.push_back(outcome->status().message);
      continue;
    }
    ++draft.report.frames;
    add_frame(**outcome, draft);
    draft.report.outcomes.push_back(std::move(**outcome));
  }
  EvaluationReport report = finished(std::move(draft), objects);
  if (options.bop_errors) add_bop(report);
  add_time(report);
  return report;
}

Result<EvaluationReport> evaluate_nothing_there(const std::vector<io::FrameResult>& results,
                                                const EvaluationOptions& options) {
  std::vector<io::BopFrame> frames;
  EvalObjects objects;
  for (const io::FrameResult& result : results) {
    frames.emplace_back();
    frames.back().scene_id = result.scene_id;
    frames.back().im_id = result.im_id;
    frames.back().has_truth = true;
    for (const Interpretation& interpretation : result.interpretations) {
      for (const Placement& placement : interpretation.placements) {
        objects[placement.model_number].name =
            placement.model.empty() ? io::bop_object_name(placement.model_number) : placement.model;
      }
    }
  }
  EvaluationOptions without_bop = options;
  without_bop.bop_errors = false;  // there is nothing to recall
  return evaluate(frames, objects, results, without_bop);
}

}  // namespace bpa::eval
