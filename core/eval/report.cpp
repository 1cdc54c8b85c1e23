// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "core/base/concat.hpp"
#include "core/eval/evaluation.hpp"

namespace bpa::eval {

using Json = nlohmann::json;

static void to_json(Json& json, const Ratio& ratio) {
  json = {{"value", ratio.total > 0 ? Json(ratio.value()) : Json()},
          {"hits", ratio.hits},
          {"total", ratio.total}};
}

static void to_json(Json& json, const ReliabilityBin& bin) {
  json = {{"low", bin.low},
          {"high", bin.high},
          {"mean_probability", bin.mean_probability},
          {"correct", bin.correct}};
}

static void to_json(Json& json, const ThresholdPoint& point) {
  json = {{"threshold", point.threshold},
          {"precision", point.precision},
          {"recall", point.recall},
          {"false_positives_per_frame", point.false_positives_per_frame}};
}

static void to_json(Json& json, const Coverage& coverage) {
  json = {{"level", coverage.level}, {"covered", coverage.covered}};
}

static void to_json(Json& json, const FrameOutcome& frame) {
  Json found = Json::array(), missed = Json::array(), false_alarms = Json::array();
  for (const TruthOutcome& truth : frame.truth) {
    if (truth.counts) (truth.found ? found : missed).push_back(truth.obj_id);
  }
  for (const EstimateOutcome& estimate : frame.estimates) {
    if (estimate.truth < 0) false_alarms.push_back(estimate.obj_id);
  }
  json = {{"scene_id", frame.scene_id}, {"im_id", frame.im_id},
          {"seconds", frame.seconds},   {"found", found},
          {"missed", missed},           {"false_alarms", false_alarms}};
}

namespace {

std::string percent(const Ratio& ratio) {
  if (ratio.total == 0) return "      -          ";
  return format("%5.1f %% (%d/%d)", 100 * ratio.value(), ratio.hits, ratio.total);
}

std::string row(const std::string& name, const std::string& value, const std::string& more = "") {
  return format("  %-24s %-18s %s\n", name.c_str(), value.c_str(), more.c_str());
}

std::string heading(const char* name, const char* value, const char* more = "") {
  return format("\n%-26s %-18s %s\n", name, value, more);
}

std::string groups_text(const char* title, const std::vector<Group>& groups, bool precision) {
  std::string text = heading(title, "recall", precision ? "precision" : "");
  for (const Group& group : groups) {
    text += row(group.name, percent(group.recall), precision ? percent(group.precision) : "");
  }
  return text;
}

std::string bins_text(const char* said, const std::vector<ReliabilityBin>& bins) {
  std::string text;
  for (const ReliabilityBin& bin : bins) {
    if (bin.correct.total == 0) continue;
    text += row(format("%s %.2f", said, bin.mean_probability), "right " + percent(bin.correct));
  }
  return text;
}

std::string frames_text(const EvaluationReport& report) {
  std::string text = format("%d frames, %d instances that count, %d placements reported\n",
                            report.frames, report.recall.total, report.precision.total);
  if (report.recall.total > 0) {
    text += format("visible fraction           median %.2f; instances by tenths:",
                   report.median_visible_fraction);
    for (const int count : report.visible_tenths) text += format(" %d", count);
    text += "\n";
  }
  const FalseReports& false_reports = report.false_reports;
  if (false_reports.free_frames > 0) {
    text +=
        format("frames without an object   %d; %d of them with %d false positives\n",
               false_reports.free_frames, false_reports.frames_with_report, false_reports.reports);
  }
  return text;
}

std::string accuracy_text(const EvaluationReport& report) {
  std::string text = heading("best interpretation", "2.5 cm, pi/16", "RMSE 1 cm");
  text += row("precision", percent(report.precision), percent(report.rmse_precision));
  text += row("object present", percent(report.present));
  text += row("recall", percent(report.recall), percent(report.rmse_recall));
  text += heading("interpretations", "recall", "truth among the alternatives");
  for (const auto& [rank, ratio] : report.recall_at) {
    const auto among = report.among_alternatives_at.find(rank);
    const bool known = among != report.among_alternatives_at.end();
    text += row(std::to_string(rank), percent(ratio), known ? percent(among->second) : "");
  }
  if (report.has_bop) {
    text += heading("BOP", "average recall");
    text += format("  VSD %.3f   MSSD %.3f   MSPD %.3f   AR %.3f\n", report.vsd, report.mssd,
                   report.mspd, report.average_recall);
    text += row("ADD(-S) < 0.1 d", percent(report.add_recall));
  }
  return text + format("  mean of found instances  ADD %.1f mm   ADD-S %.1f mm\n",
                       1000 * report.mean_add, 1000 * report.mean_adds);
}

/// Every fourth point: 0.1, 0.3, ..., 0.9.
std::string curve_text(const EvaluationReport& report) {
  std::string text =
      heading("probability at least", "precision", "recall             false positives a frame");
  for (std::size_t i = 1; i < report.threshold_curve.size(); i += 4) {
    const ThresholdPoint& point = report.threshold_curve[i];
    text +=
        row(format("%.1f", point.threshold), percent(point.precision),
            format("%-18s %.2f", percent(point.recall).c_str(), point.false_positives_per_frame));
  }
  return text;
}

std::string calibration_text(const EvaluationReport& report) {
  std::string text =
      heading("calibration", format("Brier score %.3f", report.brier).c_str(),
              format("expected error %.3f", report.expected_calibration_error).c_str());
  text += bins_text("probability", report.reliability);
  text += heading("credible region, %", "holds the truth");
  for (const Coverage& coverage : report.coverage) {
    text += row(format("%.0f", 100 * coverage.level), percent(coverage.covered));
  }
  if (!report.coverage.empty() && report.coverage.front().covered.total > 0) {
    text += format("  mean squared error in standard deviations %.3f (1 is right)\n",
                   report.normalised_square);
  }
  if (report.open_poses.held.total == 0) return text;
  text += heading("placements with alternatives of objects that are there", "");
  text += row("own pose right", percent(report.open_poses.own));
  text += row("own or an alternative", percent(report.open_poses.held));
  return text + bins_text("weight", report.open_poses.weights);
}

Json ranks_json(const std::map<int, Ratio>& ratios) {
  Json json = Json::object();
  for (const auto& [rank, ratio] : ratios) json[std::to_string(rank)] = ratio;
  return json;
}

Json groups_json(const std::vector<Group>& groups, bool precision) {
  Json json = Json::array();
  for (const Group& group : groups) {
    json.push_back({{"name", group.name}, {"recall", group.recall}});
    if (precision) json.back()["precision"] = group.precision;
  }
  return json;
}

}  // namespace

std::string report_text(const EvaluationReport& report) {
  return frames_text(report) + accuracy_text(report) +
         groups_text("object", report.by_object, true) +
         groups_text("visible fraction", report.by_visible_fraction, false) +
         groups_text("distance", report.by_distance, true) + curve_text(report) +
         calibration_text(report) +
         format("\nseconds a frame            median %.2f, mean %.2f, largest %.2f\n",
                report.time.median, report.time.mean, report.time.max);
}

std::string report_json(const EvaluationReport& report) {
  Json json = {{"format", "bpa evaluation"},
               {"version", 1},
               {"frames", report.frames},
               {"precision", report.precision},
               {"present", report.present},
               {"recall", report.recall},
               {"recall_at", ranks_json(report.recall_at)},
               {"among_alternatives_at", ranks_json(report.among_alternatives_at)},
               {"threshold_curve", report.threshold_curve},
               {"rmse", {{"precision", report.rmse_precision}, {"recall", report.rmse_recall}}},
               {"mean_add_m", report.mean_add},
               {"mean_adds_m", report.mean_adds},
               {"by_object", groups_json(report.by_object, true)},
               {"by_visible_fraction", groups_json(report.by_visible_fraction, false)},
               {"by_distance", groups_json(report.by_distance, true)},
               {"calibration",
                {{"brier", report.brier},
                 {"expected_error", report.expected_calibration_error},
                 {"bins", report.reliability}}},
               {"coverage", report.coverage},
               {"normalised_square", report.normalised_square},
               {"open_poses", {{"own", report.open_poses.own}, {"held", report.open_poses.held}}},
               {"false_reports",
                {{"free_frames", report.false_reports.free_frames},
                 {"frames_with_report", report.false_reports.frames_with_report},
                 {"reports", report.false_reports.reports}}},
               {"visible_fraction",
                {{"median", report.median_visible_fraction}, {"tenths", report.visible_tenths}}},
               {"seconds",
                {{"frames", report.time.frames},
                 {"mean", report.time.mean},
                 {"median", report.time.median},
                 {"max", report.time.max}}},
               {"outcomes", report.outcomes}};
  if (report.has_bop) {
    json["bop"] = {{"vsd", report.vsd},
                   {"mssd", report.mssd},
                   {"mspd", report.mspd},
                   {"average_recall", report.average_recall},
                   {"add_recall", report.add_recall}};
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace bpa::eval
