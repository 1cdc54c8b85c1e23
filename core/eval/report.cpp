// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/report.hpp"

#include <cstdarg>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace bpa::eval {
namespace {

using Json = nlohmann::json;

__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

std::string percent(const Ratio& ratio) {
  if (ratio.total == 0) return "      -          ";
  return format("%5.1f %% (%d/%d)", 100 * ratio.value(), ratio.hits, ratio.total);
}

std::string groups_text(const char* title, const std::vector<Group>& groups, bool precision) {
  std::string text = format("\n%-26s %-18s %s\n", title, "recall", precision ? "precision" : "");
  for (const Group& group : groups) {
    text += format("  %-24s %-18s %s\n", group.name.c_str(), percent(group.recall).c_str(),
                   precision ? percent(group.precision).c_str() : "");
  }
  return text;
}

Json ratio_json(const Ratio& ratio) {
  return {{"value", ratio.total > 0 ? Json(ratio.value()) : Json()},
          {"hits", ratio.hits},
          {"total", ratio.total}};
}

Json groups_json(const std::vector<Group>& groups, bool precision) {
  Json json = Json::array();
  for (const Group& group : groups) {
    Json row = {{"name", group.name}, {"recall", ratio_json(group.recall)}};
    if (precision) row["precision"] = ratio_json(group.precision);
    json.push_back(row);
  }
  return json;
}

Json frames_json(const EvaluationReport& report) {
  Json json = Json::array();
  for (const FrameOutcome& frame : report.outcomes) {
    Json found = Json::array(), missed = Json::array(), false_alarms = Json::array();
    for (const TruthOutcome& truth : frame.truth) {
      if (truth.counts) (truth.found ? found : missed).push_back(truth.obj_id);
    }
    for (const EstimateOutcome& estimate : frame.estimates) {
      if (estimate.truth < 0) false_alarms.push_back(estimate.obj_id);
    }
    json.push_back({{"scene_id", frame.scene_id},
                    {"im_id", frame.im_id},
                    {"seconds", frame.seconds},
                    {"found", found},
                    {"missed", missed},
                    {"false_alarms", false_alarms}});
  }
  return json;
}

Json calibration_json(const EvaluationReport& report) {
  Json bins = Json::array();
  for (const ReliabilityBin& bin : report.reliability) {
    bins.push_back({{"low", bin.low},
                    {"high", bin.high},
                    {"mean_probability", bin.mean_probability},
                    {"correct", ratio_json(bin.correct)}});
  }
  return {{"brier", report.brier}, {"bins", bins}};
}

}  // namespace

std::string report_text(const EvaluationReport& report) {
  std::string text = format("%d frames, %d instances that count, %d reported\n", report.frames,
                            report.recall.total, report.precision.total);
  if (report.recall.total > 0) {
    text += format("visible fraction           median %.2f; instances by tenths:",
                   report.median_visible_fraction);
    for (const int count : report.visible_tenths) text += format(" %d", count);
    text += "\n";
  }
  if (report.false_reports.free_frames > 0) {
    text +=
        format("nothing to find            in %d frames; something reported in %d, %d reports\n",
               report.false_reports.free_frames, report.false_reports.frames_with_report,
               report.false_reports.reports);
  }
  text += "\nbest interpretation        2.5 cm, pi/16      RMSE 1 cm\n";
  text += format("  %-24s %-18s %s\n", "precision", percent(report.precision).c_str(),
                 percent(report.rmse_precision).c_str());
  text += format("  %-24s %-18s %s\n", "recall", percent(report.recall).c_str(),
                 percent(report.rmse_recall).c_str());
  text += "\ninterpretations            recall\n";
  for (const auto& [rank, ratio] : report.recall_at) {
    text += format("  %-24d %s\n", rank, percent(ratio).c_str());
  }
  if (report.has_bop) {
    text += "\nBOP                        average recall\n";
    text += format("  VSD %.3f   MSSD %.3f   MSPD %.3f   AR %.3f\n", report.vsd, report.mssd,
                   report.mspd, report.average_recall);
    text += format("  ADD(-S) < 0.1 d          %s\n", percent(report.add_recall).c_str());
  }
  text += format("  of what was found        ADD %.1f mm   ADD-S %.1f mm\n", 1000 * report.mean_add,
                 1000 * report.mean_adds);
  text += groups_text("object", report.by_object, true);
  text += groups_text("visible fraction", report.by_visible_fraction, false);
  text += groups_text("distance", report.by_distance, true);
  text += format("\ncalibration                Brier score %.3f\n", report.brier);
  for (const ReliabilityBin& bin : report.reliability) {
    if (bin.correct.total == 0) continue;
    text += format("  said %.2f                right %s\n", bin.mean_probability,
                   percent(bin.correct).c_str());
  }
  text += "\ncredible region            holds the truth\n";
  for (const Coverage& coverage : report.coverage) {
    text += format("  %-24.0f %s\n", 100 * coverage.level, percent(coverage.covered).c_str());
  }
  if (!report.coverage.empty() && report.coverage.front().covered.total > 0) {
    text += format("  mean square of the error in standard deviations %.3f (1 would be right)\n",
                   report.normalised_square);
  }
  if (report.open_poses.held.total > 0) {
    text += format("\nplacements with alternatives, the object being there\n");
    text += format("  own pose right           %s\n", percent(report.open_poses.own).c_str());
    text += format("  or one of the others     %s\n", percent(report.open_poses.held).c_str());
    for (const ReliabilityBin& bin : report.open_poses.weights) {
      if (bin.correct.total == 0) continue;
      text += format("  weight %.2f              right %s\n", bin.mean_probability,
                     percent(bin.correct).c_str());
    }
  }
  text += format("\nseconds a frame            median %.2f, mean %.2f, largest %.2f\n",
                 report.time.median, report.time.mean, report.time.max);
  return text;
}

std::string report_json(const EvaluationReport& report) {
  Json recall_at = Json::object();
  for (const auto& [rank, ratio] : report.recall_at) {
    recall_at[std::to_string(rank)] = ratio_json(ratio);
  }
  Json coverage = Json::array();
  for (const Coverage& c : report.coverage) {
    coverage.push_back({{"level", c.level}, {"covered", ratio_json(c.covered)}});
  }
  Json json = {
      {"format", "bpa evaluation"},
      {"version", 1},
      {"frames", report.frames},
      {"precision", ratio_json(report.precision)},
      {"recall", ratio_json(report.recall)},
      {"recall_at", recall_at},
      {"rmse",
       {{"precision", ratio_json(report.rmse_precision)},
        {"recall", ratio_json(report.rmse_recall)}}},
      {"mean_add_m", report.mean_add},
      {"mean_adds_m", report.mean_adds},
      {"by_object", groups_json(report.by_object, true)},
      {"by_visible_fraction", groups_json(report.by_visible_fraction, false)},
      {"by_distance", groups_json(report.by_distance, true)},
      {"calibration", calibration_json(report)},
      {"coverage", coverage},
      {"normalised_square", report.normalised_square},
      {"open_poses",
       {{"own", ratio_json(report.open_poses.own)}, {"held", ratio_json(report.open_poses.held)}}},
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
      {"outcomes", frames_json(report)}};
  if (report.has_bop) {
    json["bop"] = {{"vsd", report.vsd},
                   {"mssd", report.mssd},
                   {"mspd", report.mspd},
                   {"average_recall", report.average_recall},
                   {"add_recall", ratio_json(report.add_recall)}};
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace bpa::eval
