// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa evaluate: results against truth.
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>

#include "core/draw/report_plots.hpp"
#include "core/eval/evaluation.hpp"
#include "core/eval/report.hpp"
#include "core/io/file_bytes.hpp"
#include "tools/command.hpp"
#include "tools/progress.hpp"

namespace bpa::cli {
namespace {

struct EvaluateArguments {
  CommonOptions common;
  DatasetOptions dataset;
  std::string csv, json, json_out, plots;
  bool nothing_there = false;
  eval::EvaluationOptions options;
};

Result<std::vector<io::FrameResult>> read_results(const EvaluateArguments& a) {
  return a.csv.empty() ? io::read_results_json(a.json) : io::read_results_csv(a.csv);
}

Result<eval::EvaluationReport> report_on(const EvaluateArguments& a) {
  eval::EvaluationOptions options = a.options;
  options.num_threads = a.common.threads;
  if (a.nothing_there) {
    const auto results = read_results(a);
    if (!results.ok()) return results.status();
    return eval::evaluate_nothing_there(*results, options);
  }
  const auto frames = io::read_bop_frames(a.dataset.folder, a.dataset.split, a.dataset.scenes);
  if (!frames.ok()) return frames.status();
  const auto results = read_results(a);
  if (!results.ok()) return results.status();
  const auto objects = eval::load_eval_objects(a.dataset.folder);
  if (!objects.ok()) return objects.status();
  Progress progress("evaluate", static_cast<int>(frames->size()));
  progress.show(0);
  return eval::evaluate(*frames, *objects, *results, options,
                        [&progress](int done) { progress.show(done); });
}

Status evaluate(const EvaluateArguments& a) {
  const Result<eval::EvaluationReport> report = report_on(a);
  if (!report.ok()) return report.status();
  std::fputs(eval::report_text(*report).c_str(), stdout);
  if (!a.json_out.empty()) {
    if (Status s = io::write_file(a.json_out, eval::report_json(*report)); !s.ok()) return s;
  }
  return a.plots.empty() ? Status() : draw::write_plots(a.plots, *report);
}

}  // namespace

void add_evaluate_command(CLI::App& program, Action& action) {
  CLI::App& command = *program.add_subcommand("evaluate", "Compare results with the truth");
  const auto a = std::make_shared<EvaluateArguments>();
  auto* bop = command.add_option("--bop", a->dataset.folder, "Folder of a BOP data set with truth");
  bop->type_name("DIR");
  command.add_flag("--nothing-there", a->nothing_there,
                   "Instead of --bop: the frames hold no known object, all placements are false");
  add_split_options(command, a->dataset);
  auto* csv = command.add_option("--csv", a->csv, "Results as BOP CSV")->type_name("FILE");
  auto* json = command.add_option("--json", a->json, "Results as JSON")->type_name("FILE");
  csv->excludes(json);
  command.add_option("--json-out", a->json_out, "Write the report as JSON")->type_name("FILE");
  command.add_option("--plots", a->plots, "Write plots as PNG")->type_name("DIR");
  add_min_visible_option(command, a->options.min_visible_fraction);
  add_common_options(command, a->common);
  command.callback([&action, a] {
    if (a->csv.empty() == a->json.empty()) {
      throw CLI::ValidationError("results", "give one of --csv and --json");
    }
    if (a->dataset.folder.empty() != a->nothing_there) {
      throw CLI::ValidationError("truth", "give one of --bop and --nothing-there");
    }
    action = [a] { return evaluate(*a); };
  });
}

}  // namespace bpa::cli
