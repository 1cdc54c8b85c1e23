// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/evaluation.hpp"

#include <algorithm>
#include <cstdio>
#include <mutex>
#include <numeric>
#include <optional>

#include "core/base/parallel.hpp"
#include "core/eval/private/frame_evaluation.hpp"

namespace bpa::eval {
namespace {

constexpr double kMetresPerMillimetre = 0.001;
constexpr int kRanks[] = {1, 2, 3, 5, 10, 20};
constexpr int kBins = 10;
// Quantiles of chi-squared with 3 to 6 degrees of freedom.
constexpr struct {
  double level;
  double quantile[4];
} kChiSquared[] = {{0.50, {2.3660, 3.3567, 4.3515, 5.3481}},
                   {0.90, {6.2514, 7.7794, 9.2364, 10.6446}},
                   {0.95, {7.8147, 9.4877, 11.0705, 12.5916}}};

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
      return invalid_argument(frame_name(frames[i].scene_id, frames[i].im_id) +
                              " has no truth (scene_gt.json); evaluation needs it");
    }
    for (const io::BopInstance& instance : frames[i].truth) {
      if (objects.count(instance.obj_id) == 0) {
        return invalid_argument("the truth of " + frame_name(frames[i].scene_id, frames[i].im_id) +
                                " has obj_id " + std::to_string(instance.obj_id) +
                                ", which is not among the models");
      }
    }
  }
  std::vector<const io::FrameResult*> assigned(frames.size(), nullptr);
  for (const io::FrameResult& result : results) {
    const auto found = index.find({result.scene_id, result.im_id});
    if (found == index.end()) {
      return invalid_argument("the results have " + frame_name(result.scene_id, result.im_id) +
                              ", which is not in the data set");
    }
    for (const Interpretation& interpretation : result.interpretations) {
      for (const Placement& placement : interpretation.placements) {
        if (objects.count(placement.model_number) == 0) {
          return invalid_argument("the results have obj_id " +
                                  std::to_string(placement.model_number) +
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

std::string range_name(double low, double high, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.1f-%.1f%s", low, high, unit);
  return text;
}

/// Rows of equal width from `first`; the last one takes everything beyond.
std::vector<Group> range_groups(double first, double width, int rows, const char* unit) {
  std::vector<Group> groups(static_cast<std::size_t>(rows));
  for (int i = 0; i < rows; ++i) {
    groups[static_cast<std::size_t>(i)].name =
        range_name(first + i * width, first + (i + 1) * width, unit);
  }
  return groups;
}

Group& group_of(std::vector<Group>& groups, double first, double width, double value) {
  const int row = static_cast<int>((value - first) / width + 1e-9);
  return groups[static_cast<std::size_t>(std::clamp(row, 0, static_cast<int>(groups.size()) - 1))];
}

void add_groups(const EvalObjects& objects, EvaluationReport& report) {
  std::map<int, Group> by_object;
  report.by_visible_fraction = range_groups(0.1, 0.1, 9, "");
  report.by_distance = range_groups(0.4, 0.2, 8, " m");
  for (const FrameOutcome& frame : report.outcomes) {
    for (const TruthOutcome& truth : frame.truth) {
      if (!truth.counts) continue;
      count(by_object[truth.obj_id].recall, truth.found);
      count(group_of(report.by_visible_fraction, 0.1, 0.1, truth.visible_fraction).recall,
            truth.found);
      count(group_of(report.by_distance, 0.4, 0.2, truth.distance).recall, truth.found);
    }
    for (const EstimateOutcome& estimate : frame.estimates) {
      if (estimate.ignored) continue;
      count(by_object[estimate.obj_id].precision, estimate.truth >= 0);
      count(group_of(report.by_distance, 0.4, 0.2, estimate.distance).precision,
            estimate.truth >= 0);
    }
  }
  for (auto& [obj_id, group] : by_object) {
    group.name = objects.at(obj_id).name;
    report.by_object.push_back(group);
  }
  const auto empty = [](const Group& g) { return g.recall.total + g.precision.total == 0; };
  std::erase_if(report.by_visible_fraction, empty);
  std::erase_if(report.by_distance, empty);
}

std::vector<ReliabilityBin> empty_bins() {
  std::vector<ReliabilityBin> bins(kBins);
  for (int i = 0; i < kBins; ++i) {
    bins[static_cast<std::size_t>(i)].low = i / static_cast<double>(kBins);
    bins[static_cast<std::size_t>(i)].high = (i + 1) / static_cast<double>(kBins);
  }
  return bins;
}

void add_to_bins(std::vector<ReliabilityBin>& bins, double probability, bool right) {
  ReliabilityBin& bin = bins[static_cast<std::size_t>(
      std::clamp(static_cast<int>(probability * kBins), 0, kBins - 1))];
  bin.mean_probability += probability;
  count(bin.correct, right);
}

void finish_bins(std::vector<ReliabilityBin>& bins) {
  for (ReliabilityBin& bin : bins) {
    if (bin.correct.total > 0) bin.mean_probability /= bin.correct.total;
  }
}

void add_open_poses(EvaluationReport& report) {
  OpenPoses& open = report.open_poses;
  open.weights = empty_bins();
  for (const FrameOutcome& frame : report.outcomes) {
    for (const EstimateOutcome& estimate : frame.estimates) {
      if (estimate.poses.empty()) continue;
      bool any = false;
      for (const PoseOutcome& pose : estimate.poses) {
        any = any || pose.right;
        add_to_bins(open.weights, pose.weight, pose.right);
      }
      count(open.held, any);
      count(open.own, estimate.poses.front().right);
    }
  }
  finish_bins(open.weights);
}

void add_calibration(EvaluationReport& report) {
  report.reliability = empty_bins();
  for (const auto& row : kChiSquared) report.coverage.push_back({row.level, {}});
  double squared = 0;
  int reported = 0, with_covariance = 0;
  for (const FrameOutcome& frame : report.outcomes) {
    for (const EstimateOutcome& estimate : frame.estimates) {
      if (estimate.ignored) continue;
      const bool correct = estimate.truth >= 0;
      const double p = std::clamp(estimate.probability, 0.0, 1.0);
      squared += (p - correct) * (p - correct);
      ++reported;
      add_to_bins(report.reliability, p, correct);
      if (!correct || !estimate.has_covariance) continue;
      ++with_covariance;
      report.normalised_square += estimate.mahalanobis_squared / estimate.degrees_of_freedom;
      for (std::size_t i = 0; i < std::size(kChiSquared); ++i) {
        count(report.coverage[i].covered,
              estimate.mahalanobis_squared <=
                  kChiSquared[i].quantile[estimate.degrees_of_freedom - 3]);
      }
    }
  }
  if (with_covariance > 0) report.normalised_square /= with_covariance;
  report.brier = reported > 0 ? squared / reported : 0;
  finish_bins(report.reliability);
}

/// The middle value; of an even number of them, the mean of the middle two.
double median(const std::vector<double>& sorted) {
  const std::size_t n = sorted.size();
  return 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
}

void add_time(EvaluationReport& report) {
  const std::vector<double> seconds = sorted_seconds(report);
  if (seconds.empty()) return;
  report.time.frames = static_cast<int>(seconds.size());
  report.time.mean =
      std::accumulate(seconds.begin(), seconds.end(), 0.0) / static_cast<double>(seconds.size());
  report.time.median = median(seconds);
  report.time.max = seconds.back();
}

void add_scenes(EvaluationReport& report) {
  std::vector<double> fractions;
  for (const FrameOutcome& frame : report.outcomes) {
    bool free = true;
    for (const TruthOutcome& truth : frame.truth) {
      free = free && !truth.counts;
      fractions.push_back(truth.visible_fraction);
      const int tenth = std::clamp(static_cast<int>(10 * truth.visible_fraction + 1e-9), 0, 9);
      ++report.visible_tenths[static_cast<std::size_t>(tenth)];
    }
    if (!free) continue;
    const auto reports = static_cast<int>(
        std::count_if(frame.estimates.begin(), frame.estimates.end(),
                      [](const EstimateOutcome& estimate) { return !estimate.ignored; }));
    ++report.false_reports.free_frames;
    report.false_reports.frames_with_report += reports > 0;
    report.false_reports.reports += reports;
  }
  if (fractions.empty()) return;
  std::sort(fractions.begin(), fractions.end());
  report.median_visible_fraction = median(fractions);
}

void add_paper(EvaluationReport& report) {
  int found = 0;
  for (const FrameOutcome& frame : report.outcomes) {
    for (const EstimateOutcome& estimate : frame.estimates) {
      if (!estimate.ignored) count(report.precision, estimate.truth >= 0);
    }
    report.rmse_precision.hits += frame.rmse_correct;
    report.rmse_precision.total += frame.rmse_reported;
    for (const TruthOutcome& truth : frame.truth) {
      if (!truth.counts) continue;
      count(report.recall, truth.found);
      count(report.rmse_recall, truth.found_rmse);
      for (const int rank : kRanks) {
        count(report.recall_at[rank], truth.found_at_rank > 0 && truth.found_at_rank <= rank);
      }
      if (!truth.found) continue;
      ++found;
      report.mean_add += truth.add;
      report.mean_adds += truth.adds;
    }
  }
  if (found == 0) return;
  report.mean_add /= found;
  report.mean_adds /= found;
}

void add_bop(EvaluationReport& report) {
  report.has_bop = true;
  double vsd = 0, mssd = 0, mspd = 0;
  for (const FrameOutcome& frame : report.outcomes) {
    report.add_recall.hits += frame.add_correct;
    mssd += std::accumulate(frame.mssd.begin(), frame.mssd.end(), 0.0);
    mspd += std::accumulate(frame.mspd.begin(), frame.mspd.end(), 0.0);
    for (const auto& row : frame.vsd) vsd += std::accumulate(row.begin(), row.end(), 0.0);
  }
  report.add_recall.total = report.recall.total;
  if (report.recall.total == 0) return;
  report.vsd = vsd / (100.0 * report.recall.total);
  report.mssd = mssd / (10.0 * report.recall.total);
  report.mspd = mspd / (10.0 * report.recall.total);
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
  parallel_for(static_cast<int>(frames.size()), options.num_threads, [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    outcomes[i] = evaluate_frame(frames[i], objects, (*assigned)[i], options);
    const std::lock_guard lock(mutex);
    ++done;
    if (progress) progress(done);
  });
  EvaluationReport report;
  report.frames = static_cast<int>(frames.size());
  for (auto& outcome : outcomes) {
    if (!outcome->ok()) return outcome->status();
    report.outcomes.push_back(std::move(**outcome));
  }
  add_paper(report);
  if (options.bop_errors) add_bop(report);
  add_groups(objects, report);
  add_calibration(report);
  add_open_poses(report);
  add_scenes(report);
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
