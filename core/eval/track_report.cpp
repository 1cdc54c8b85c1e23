// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "core/base/concat.hpp"
#include "core/eval/track_evaluation.hpp"

namespace bpa::eval {
namespace {

using nlohmann::json;

std::string share(int hits, int total) {
  return total > 0 ? format("%5.1f %%", 100.0 * hits / total) : "      -";
}

std::string counts_row(const std::string& name, const TrackCounts& c) {
  return format("  %-8s %8d %7d %6d %7d  %6.3f %6.3f %8.1f %8.3f %9s %9s\n", name.c_str(),
                c.instances, c.instances - c.matched, c.false_reports, c.switches, c.mota(),
                c.idf1(), 1000 * c.motp_m(), c.adds_auc(), share(c.within_2cm, c.instances).c_str(),
                share(c.right, c.instances).c_str());
}

std::string counts_table(const TrackReport& report, const char* title,
                         TrackCounts TrackMeasures::*counts) {
  std::string text = format("\n%s\n  %-8s %8s %7s %6s %7s  %6s %6s %8s %8s %9s %9s\n", title,
                            "sequence", "objects", "missed", "false", "switch", "MOTA", "IDF1",
                            "MOTP mm", "ADD-S", "ADD-S<2cm", "right");
  for (const TrackMeasures& sequence : report.sequences) {
    text += counts_row(sequence.name, sequence.*counts);
  }
  return text + counts_row(report.total.name, report.total.*counts);
}

std::string other_row(const TrackMeasures& m) {
  const auto counted = [](const Ratio& ratio) {
    return ratio.total > 0 ? format("%d/%d", ratio.hits, ratio.total) : std::string("-");
  };
  return format("  %-8s %7d  %11s %12s  %6.2f %9s  %8.1f %8.1f\n", m.name.c_str(), m.frames,
                counted(m.hidden_held).c_str(), counted(m.right_at_end).c_str(), m.nees(),
                share(m.nees_within.hits, m.nees_within.total).c_str(), m.milliseconds_at(0.5),
                m.milliseconds_at(0.99));
}

json ratio_json(const Ratio& ratio) {
  return {{"value", ratio.total > 0 ? json(ratio.value()) : json()},
          {"hits", ratio.hits},
          {"total", ratio.total}};
}

json counts_json(const TrackCounts& c) {
  return {{"instances", c.instances},
          {"matched", c.matched},
          {"false", c.false_reports},
          {"switches", c.switches},
          {"objects", c.objects},
          {"mota", c.mota()},
          {"motp_m", c.motp_m()},
          {"idf1", c.idf1()},
          {"adds_auc", c.adds_auc()},
          {"adds_within_2cm", ratio_json({c.within_2cm, c.instances})},
          {"right", ratio_json({c.right, c.instances})}};
}

json measures_json(const TrackMeasures& m) {
  return {{"name", m.name},
          {"frames", m.frames},
          {"visible", counts_json(m.visible)},
          {"all", counts_json(m.all)},
          {"hidden_held", ratio_json(m.hidden_held)},
          {"right_at_end", ratio_json(m.right_at_end)},
          {"nees", {{"mean", m.nees()}, {"within_95", ratio_json(m.nees_within)}}},
          {"milliseconds",
           {{"frames", m.milliseconds.size()},
            {"median", m.milliseconds_at(0.5)},
            {"p99", m.milliseconds_at(0.99)}}}};
}

}  // namespace

std::string track_report_text(const TrackReport& report) {
  std::string text = format(
      "matches within %.1f cm; ADD-S: area under its curve up to 10 cm; right: 2.5 cm, pi/16\n",
      100 * report.options.match_m);
  text += counts_table(report, "visible objects", &TrackMeasures::visible);
  text += counts_table(
      report, format("and objects hidden for at most %g s", report.options.hidden_s).c_str(),
      &TrackMeasures::all);
  text += format("\n  %-8s %7s  %11s %12s  %6s %9s  %8s %8s\n", "sequence", "frames", "hidden held",
                 "right at end", "NEES", "in 95 %", "ms, 50 %", "99 %");
  for (const TrackMeasures& sequence : report.sequences) text += other_row(sequence);
  return text + other_row(report.total);
}

std::string track_report_json(const TrackReport& report) {
  json sequences = json::array();
  for (const TrackMeasures& sequence : report.sequences) {
    sequences.push_back(measures_json(sequence));
  }
  const json all = {{"format", "bpa track evaluation"},
                    {"version", 1},
                    {"match_m", report.options.match_m},
                    {"min_visible_fraction", report.options.min_visible_fraction},
                    {"hidden_s", report.options.hidden_s},
                    {"sequences", sequences},
                    {"total", measures_json(report.total)}};
  return all.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace bpa::eval
