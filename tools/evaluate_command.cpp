// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa evaluate: results and tracks against truth.
#include <cstdio>

#include "core/draw/report_plots.hpp"
#include "core/eval/evaluation.hpp"
#include "core/eval/track_evaluation.hpp"
#include "core/io/file_bytes.hpp"
#include "tools/command.hpp"

namespace bpa::cli {
namespace {

struct EvaluateArguments {
  CommonOptions common;
  DatasetOptions dataset;
  std::string csv, json, tracks, json_out, plots;
  bool nothing_there = false;
  eval::EvaluationOptions options;
  eval::TrackEvaluationOptions track_options;
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

/// A file of tracks, or of results, whose detections are linked.
std::vector<io::TrackResult> read_tracks(const std::string& path) {
  const auto results = io::read_results_json(path);
  if (results.ok()) return eval::linked_detections(*results);
  return or_throw(io::read_tracks_json(path));
}

void evaluate_tracks(const EvaluateArguments& a) {
  if (a.dataset.folder.empty() || !a.plots.empty()) {
    throw CLI::ValidationError("tracks", "--tracks needs --bop, and has no --plots");
  }
  eval::TrackEvaluationOptions options = a.track_options;
  options.min_visible_fraction = a.options.min_visible_fraction;
  options.num_threads = a.common.threads;
  const std::vector<io::TrackResult> tracks = read_tracks(a.tracks);
  const auto frames =
      or_throw(io::read_bop_frames(a.dataset.folder, a.dataset.split, a.dataset.scenes));
  const eval::EvalObjects objects = or_throw(eval::load_eval_objects(a.dataset.folder));
  const eval::TrackReport report =
      or_throw(eval::evaluate_tracks(frames, objects, tracks, options));
  std::fputs(eval::track_report_text(report).c_str(), stdout);
  if (!a.json_out.empty()) or_throw(io::write_file(a.json_out, eval::track_report_json(report)));
}

void evaluate(const EvaluateArguments& a) {
  if (static_cast<int>(a.csv.empty()) + a.json.empty() + a.tracks.empty() != 2) {
    throw CLI::ValidationError("results", "give one of --csv, --json and --tracks");
  }
  if (a.dataset.folder.empty() != a.nothing_there) {
    throw CLI::ValidationError("truth", "give one of --bop and --nothing-there");
  }
  if (!a.tracks.empty()) return evaluate_tracks(a);
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
  add_option(
      command, "--tracks", a.tracks,
      "Tracks as JSON, against a sequence. Of results as JSON, the placements of each model are "
      "linked from frame to frame where they are at most 10 cm apart",
      "FILE");
  add_options(command, options_of(a.track_options),
              {{"--match", "match_m"}, {"--hidden", "hidden_s"}});
  add_option(command, "--json-out", a.json_out, "Write the report as JSON", "FILE");
  add_option(command, "--plots", a.plots, "Write plots as PNG", "DIR");
  add_min_visible_option(command, a.options.min_visible_fraction);
}

}  // namespace bpa::cli
