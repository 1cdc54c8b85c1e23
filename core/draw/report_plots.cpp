// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/draw/report_plots.hpp"

#include <cmath>

#include "core/base/concat.hpp"
#include "core/draw/plot.hpp"

namespace bpa::draw {
namespace {

using eval::EvaluationReport;
using eval::Ratio;

io::ColorImage groups_plot(const std::string& title, const std::vector<eval::Group>& groups) {
  std::vector<std::string> names, notes;
  std::vector<double> values;
  for (const eval::Group& group : groups) {
    names.push_back(group.name);
    values.push_back(group.recall.value());
    notes.push_back(std::to_string(group.recall.hits) + "/" + std::to_string(group.recall.total));
  }
  return bar_plot(title, names, values, notes);
}

/// Adds the point of a ratio, unless it is of nothing.
void add(Series& series, double x, const Ratio& ratio) {
  if (ratio.total == 0) return;
  series.x.push_back(x);
  series.y.push_back(ratio.value());
}

io::ColorImage recall_plot(const EvaluationReport& report) {
  Series recall{"recall", {}, {}};
  for (const auto& [rank, ratio] : report.recall_at) add(recall, rank, ratio);
  return line_plot({"recall by number of interpretations", "interpretations", "recall", 0, 20},
                   {recall});
}

/// Every other point says its threshold.
io::ColorImage precision_recall_plot(const EvaluationReport& report) {
  Series curve{"least probability", {}, {}};
  for (const eval::ThresholdPoint& point : report.threshold_curve) {
    if (point.precision.total == 0 || point.recall.total == 0) continue;
    add(curve, point.recall.value(), point.precision);
    const bool odd_tenth = std::lround(20 * point.threshold) % 4 == 2;
    curve.notes.push_back(odd_tenth ? fixed(point.threshold, 1) : "");
  }
  return line_plot({"precision and recall over the least probability", "recall", "precision"},
                   {curve});
}

io::ColorImage false_positives_plot(const EvaluationReport& report) {
  Series curve{std::to_string(report.frames) + " frames", {}, {}};
  for (const eval::ThresholdPoint& point : report.threshold_curve) {
    curve.x.push_back(point.threshold);
    curve.y.push_back(point.false_positives_per_frame);
  }
  return line_plot({"false positives", "least probability", "false positives a frame", 0, 1, 0, 0},
                   {curve});
}

io::ColorImage reliability_plot(const EvaluationReport& report) {
  Series series{"expected error " + fixed(report.expected_calibration_error, 3) + ", Brier score " +
                    fixed(report.brier, 3),
                {},
                {}};
  for (const auto& bin : report.reliability) add(series, bin.mean_probability, bin.correct);
  return line_plot(
      {"calibration of probabilities", "probability said", "fraction right", 0, 1, 0, 1, true},
      {series});
}

io::ColorImage coverage_plot(const EvaluationReport& report) {
  Series series{"right placements", {}, {}};
  for (const auto& coverage : report.coverage) add(series, coverage.level, coverage.covered);
  return line_plot({"do credible regions of poses hold the truth?", "probability of the region",
                    "fraction that hold it", 0, 1, 0, 1, true},
                   {series});
}

io::ColorImage reports_plot(const EvaluationReport& report) {
  std::vector<int> right, wrong;
  for (const auto& bin : report.reliability) {
    right.push_back(bin.correct.hits);
    wrong.push_back(bin.correct.total - bin.correct.hits);
  }
  return histogram_plot({"placements reported, by probability", "probability said", "placements"},
                        {"right", "false"}, {right, wrong});
}

io::ColorImage visible_histogram(const EvaluationReport& report) {
  return histogram_plot(
      {"instances of the set, by visible fraction", "visible fraction", "instances"},
      {"median " + fixed(report.median_visible_fraction, 2)},
      {{report.visible_tenths.begin(), report.visible_tenths.end()}});
}

io::ColorImage time_plot(const EvaluationReport& report) {
  Series series{"frames", eval::sorted_seconds(report), {}};
  const auto count = static_cast<double>(series.x.size());
  while (series.y.size() < series.x.size()) {
    series.y.push_back(static_cast<double>(series.y.size() + 1) / count);
  }
  return line_plot({"time of a frame", "seconds", "fraction of frames done", 0, 0}, {series});
}

}  // namespace

Status write_plots(const std::string& folder, const EvaluationReport& report) {
  const std::pair<const char*, io::ColorImage> plots[] = {
      {"recall", recall_plot(report)},
      {"precision_recall", precision_recall_plot(report)},
      {"false_positives", false_positives_plot(report)},
      {"reliability", reliability_plot(report)},
      {"coverage", coverage_plot(report)},
      {"reports", reports_plot(report)},
      {"visible_histogram", visible_histogram(report)},
      {"time", time_plot(report)},
      {"visible_fraction", groups_plot("recall by visible fraction", report.by_visible_fraction)},
      {"distance", groups_plot("recall by distance", report.by_distance)},
      {"objects", groups_plot("recall by object", report.by_object)}};
  for (const auto& [name, picture] : plots) {
    const Status status = io::write_color_png(folder + "/" + name + ".png", picture);
    if (!status.ok()) return status;
  }
  return {};
}

}  // namespace bpa::draw
