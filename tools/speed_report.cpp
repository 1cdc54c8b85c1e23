// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/speed_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "core/draw/plot.hpp"
#include "core/io/file_bytes.hpp"

namespace bpa::cli {
namespace {

constexpr const char* kFormat = "bpa speed bench";
constexpr int kVersion = 1;

/// A part of the report: rows, each with a number that names it.
struct TablePart {
  const char* key;
  const char* row_key;
  const char* title;
};
constexpr TablePart kTables[] = {{"budgets", "budget_s", "seconds allowed"},
                                 {"models", "models", "models"}};

/// Counts that are shown as parts of another.
constexpr std::pair<const char*, const char*> kShares[] = {{"right", "reported"},
                                                           {"found", "instances"},
                                                           {"found_in_twenty", "instances"},
                                                           {"found_when_given", "instances"}};
constexpr const char* kStages = "stages_ms";

std::string text(const SpeedReport& value) {
  if (!value.is_number()) return "-";
  const double number = value.get<double>();
  const bool whole = number == std::round(number) || number >= 1000;
  return fixed(number, whole ? 0 : number < 10 ? 3 : 1);
}

std::string row_name(const SpeedReport& row, const TablePart& part) {
  const SpeedReport& name = row.at(part.row_key);
  return name.is_number() ? format("%g", name.get<double>()) : "none";
}

/// A table whose columns are rows of the report.
struct Table {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::pair<std::string, std::vector<std::string>>> lines;

  void print() const {
    std::printf("\n%-28s", title.c_str());
    for (const std::string& column : columns) std::printf(" %9s", column.c_str());
    std::printf("\n");
    for (const auto& [name, cells] : lines) {
      std::printf("%-28s", name.c_str());
      for (const std::string& cell : cells) std::printf(" %9s", cell.c_str());
      std::printf("\n");
    }
  }
};

std::string words(std::string key) {
  std::ranges::replace(key, '_', ' ');
  return key;
}

Table table_of(const SpeedReport& report, const TablePart& part) {
  Table table{part.title, {}, {}};
  const SpeedReport& rows = report.at(part.key);
  for (const SpeedReport& row : rows) table.columns.push_back(row_name(row, part));
  if (rows.empty()) return table;
  for (const auto& [key, first] : rows.front().items()) {
    const auto is_total = [&name = key](const auto& share) { return name == share.second; };
    if (key == part.row_key || std::ranges::any_of(kShares, is_total)) continue;
    auto& cells = table.lines.emplace_back(words(key), std::vector<std::string>()).second;
    const auto share =
        std::ranges::find_if(kShares, [&name = key](const auto& s) { return name == s.first; });
    for (const SpeedReport& row : rows) {
      cells.push_back(text(row.at(key)));
      if (share != std::end(kShares)) cells.back() += "/" + text(row.at(share->second));
    }
  }
  return table;
}

}  // namespace

SpeedReport empty_speed_report() { return {{"format", kFormat}, {"version", kVersion}}; }

void print_speed_report(const SpeedReport& report) {
  std::printf("%s, %s threads, %s frames of %s\n", report.at("cpu").get<std::string>().c_str(),
              text(report.at("threads")).c_str(), text(report.at("frames")).c_str(),
              report.at("dataset").get<std::string>().c_str());
  for (const TablePart& part : kTables) table_of(report, part).print();
  Table stages{"stages", {"mean ms"}, {}};
  for (const auto& [stage, milliseconds] : report.at(kStages).items()) {
    stages.lines.push_back({stage, {text(milliseconds)}});
  }
  stages.print();
}

void plot_recall_over_time(const std::string& path, const SpeedReport& report) {
  draw::Series best{"best interpretation", {}, {}}, twenty{"twenty interpretations", {}, {}};
  for (const SpeedReport& row : report.at("budgets")) {
    const double instances = std::max(1.0, row.at("instances").get<double>());
    for (draw::Series* series : {&best, &twenty}) {
      series->x.push_back(1e-3 * row.at("median_ms").get<double>());
    }
    best.y.push_back(row.at("found").get<double>() / instances);
    best.notes.push_back(row_name(row, kTables[0]) + (row.at("budget_s").is_null() ? "" : " s"));
    twenty.y.push_back(row.at("found_in_twenty").get<double>() / instances);
  }
  const draw::PlotAxes axes{
      "recall over time, by budget", "median time of a frame, s", "recall", 0, 0, 0, 1};
  or_throw(io::write_color_png(path, draw::line_plot(axes, {best, twenty})));
}

}  // namespace bpa::cli
