// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa evaluate: results against truth.
#include <cstdio>

#include "core/draw/report_plots.hpp"
#include "core/eval/evaluation.hpp"
#include "core/io/file_bytes.hpp"
#include "tools/command.hpp"

namespace bpa::cli {
namespace {

struct EvaluateArguments {
  CommonOptions common;
  DatasetOptions dataset;
  std::string csv, json, json_out, plots;
  bool nothing_there = false;
  eval::EvaluationOptions options;
};

eval::EvaluationReport report_on(const EvaluateArguments& a) {
  eval::EvaluationOptions options = a.options;
  options.num_threads = a.common.threads;
  const auto read_results = [&a] {
    return or_throw(a.csv.empty() ? io::read_results_json(a.json) : io::read_results_csv(a.csv));
  };
  if (a.nothing_there) return or_throw(eval::evaluate_nothing_there(read_results(), options));
  const auto frames =
      or_throw(io::read_bop_frames(a.dataset.folder, a.dataset.split, a.dataset.scenes));
  const std::vector<io::FrameResult> results = read_results();
  const eval::EvalObjects objects = or_throw(eval::load_eval_objects(a.dataset.folder));
  Progress progress("evaluate", static_cast<int>(frames.size()));
  progress.show(0);
  return or_throw(eval::evaluate(frames, objects, results, options,
                                 [&progress](int done) { progress.show(done); }));
}

void evaluate(const EvaluateArguments& a) {
  if (a.csv.empty() == a.json.empty()) {
    throw CLI::ValidationError("results", "give one of --csv and --json");
  }
  if (a.dataset.folder.empty() != a.nothing_there) {
    throw CLI::ValidationError("truth", "give one of --bop and --nothing-there");
  }
  const eval::EvaluationReport report = report_on(a);
  std::fputs(eval::report_text(report).c_str(), stdout);
  if (!a.json_out.empty()) or_throw(io::write_file(a.json_out, eval::report_json(report)));
  if (!a.plots.empty()) or_throw(draw::write_plots(a.plots, report));
}

}  // namespace

void add_evaluate_command(CLI::App& program) {
  const auto [command, a] =
      add_command(program, "evaluate", "Compare results with the truth", evaluate);
  add_option(command, "--bop", a.dataset.folder, "Folder of a BOP data set with truth", "DIR");
  command.add_flag("--nothing-there", a.nothing_there,
                   "Instead of --bop: the frames hold no known object, all placements are false");
  add_split_options(command, a.dataset);
  auto* csv = add_option(command, "--csv", a.csv, "Results as BOP CSV", "FILE");
  add_option(command, "--json", a.json, "Results as JSON", "FILE")->excludes(csv);
  add_option(command, "--json-out", a.json_out, "Write the report as JSON", "FILE");
  add_option(command, "--plots", a.plots, "Write plots as PNG", "DIR");
  add_min_visible_option(command, a.options.min_visible_fraction);
}

}  // namespace bpa::cli
