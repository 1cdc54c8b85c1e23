// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa evaluate: results and tracks against truth.
#include <algorithm>
#include <cstdio>
#include <set>
#include <tuple>

#include "core/base/concat.hpp"
#include "core/draw/report_plots.hpp"
#include "core/eval/evaluation.hpp"
#include "core/eval/match_names.hpp"
#include "core/eval/track_evaluation.hpp"
#include "core/io/file_bytes.hpp"
#include "tools/command.hpp"

namespace bpa::cli {
namespace {

struct EvaluateArguments {
  CommonOptions common;
  DatasetOptions dataset;
  std::string csv, json, tracks, json_out, plots;
  std::vector<std::string> compared;  ///< Results as JSON, earlier and later.
  bool nothing_there = false;
  eval::EvaluationOptions options;
  eval::TrackEvaluationOptions track_options;
};

/// Gives placements or tracks the numbers that the data set has for their models.
void number_as(const eval::EvalObjects& objects, auto& results) {
  eval::ModelNames known;
  for (const auto& [number, object] : objects) known[number] = object.name;
  const std::set<std::string> lacks = eval::number_by_name(known, results);
  if (lacks.empty()) return;
  throw Failure(invalid_argument("the results have models that the data set does not have: ",
                                 listed(lacks), ". They are of another library"));
}

eval::EvaluationReport report_on(const EvaluateArguments& a) {
  eval::EvaluationOptions options = a.options;
  options.num_threads = a.common.threads;
  const auto read_results = [&a] {
    return or_throw(a.csv.empty() ? io::read_results_json(a.json) : io::read_results_csv(a.csv));
  };
  if (a.nothing_there) return or_throw(eval::evaluate_nothing_there(read_results(), options));
  const auto frames =
      or_throw(io::read_bop_frames(a.dataset.folder, a.dataset.split, a.dataset.scenes));
  std::vector<io::FrameResult> results = read_results();
  const eval::EvalObjects objects = or_throw(eval::load_eval_objects(a.dataset.folder));
  number_as(objects, results);
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
  std::vector<io::TrackResult> tracks = read_tracks(a.tracks);
  const auto frames =
      or_throw(io::read_bop_frames(a.dataset.folder, a.dataset.split, a.dataset.scenes));
  const eval::EvalObjects objects = or_throw(eval::load_eval_objects(a.dataset.folder));
  number_as(objects, tracks);
  const eval::TrackReport report =
      or_throw(eval::evaluate_tracks(frames, objects, tracks, options));
  std::fputs(eval::track_report_text(report).c_str(), stdout);
  if (!a.json_out.empty()) or_throw(io::write_file(a.json_out, eval::track_report_json(report)));
}

/// Fails where frames were left out, once the others are reported.
void check_all_judged(const eval::EvaluationReport& report) {
  if (report.left_out.empty()) return;
  print_warnings("left out", report.left_out);
  throw Failure(invalid_argument(report.left_out.size(), " of ",
                                 report.frames + report.left_out.size(),
                                 " frames could not be evaluated"));
}

/// Names of models, one for each object.
using Names = std::multiset<std::string>;

/// Those of `all` that are not in `other`.
std::string difference(const Names& all, const Names& other) {
  std::string text;
  Names rest = other;
  for (const std::string& name : all) {
    if (const auto same = rest.find(name); same != rest.end()) {
      rest.erase(same);
    } else {
      text += " " + name;
    }
  }
  return text.empty() ? " -" : text;
}

/// What a frame's result found, or its false positives.
Names names_in(const eval::FrameOutcome& frame, const eval::EvalObjects& objects, bool found) {
  Names names;
  for (const eval::TruthOutcome& truth : frame.truth) {
    if (found && truth.counts && truth.found) names.insert(objects.at(truth.obj_id).name);
  }
  for (const eval::EstimateOutcome& estimate : frame.estimates) {
    if (found || estimate.truth >= 0 || estimate.ignored) continue;
    names.insert(objects.at(estimate.obj_id).name);
  }
  return names;
}

/// What a later run found and an earlier one did not, and the reverse, frame by frame.
void compare(EvaluateArguments a) {
  if (a.compared.size() != 2 || a.dataset.folder.empty()) {
    throw CLI::ValidationError("results", "--bop and two files of results are needed to compare");
  }
  a.options.bop_errors = false;
  std::vector<eval::EvaluationReport> reports;
  for (const std::string& path : a.compared) {
    a.json = path;
    reports.push_back(report_on(a));
  }
  const auto& [before, after] = std::tie(reports[0], reports[1]);
  const eval::EvalObjects objects = or_throw(eval::load_eval_objects(a.dataset.folder));
  for (std::size_t f = 0; f < before.outcomes.size(); ++f) {
    const eval::FrameOutcome &was = before.outcomes[f], &is = after.outcomes[f];
    const std::string frame = concat("scene ", was.scene_id, " image ", was.im_id);
    if (was.reported != is.reported) {
      std::printf("%s: not searched in %s\n", frame.c_str(), a.compared[was.reported].c_str());
    }
    if (!was.reported || !is.reported) continue;
    const auto changes = [&](bool found) {
      const Names earlier = names_in(was, objects, found), later = names_in(is, objects, found);
      if (earlier == later) return std::string();
      return concat(found ? ": gained" : ": false positives gained", difference(later, earlier),
                    "; lost", difference(earlier, later));
    };
    for (const bool found : {true, false}) {
      const std::string line = changes(found);
      if (!line.empty()) std::printf("%s%s\n", frame.c_str(), line.c_str());
    }
  }
  for (std::size_t i = 0; i < 2; ++i) {
    std::printf("%s: found %d/%d, right of those reported %d/%d\n", a.compared[i].c_str(),
                reports[i].recall.hits, reports[i].recall.total, reports[i].precision.hits,
                reports[i].precision.total);
  }
}

void evaluate(const EvaluateArguments& a) {
  if (!a.compared.empty()) return compare(a);
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
  check_all_judged(report);
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
  add_option(command, "compared", a.compared,
             "Two files of results as JSON: what the second found and the first did not, and the "
             "reverse, frame by frame",
             "A.json B.json")
      ->expected(2)
      ->excludes(csv)
      ->excludes("--json");
  add_options(command, options_of(a.track_options),
              {{"--match", "match_m"}, {"--hidden", "hidden_s"}});
  add_option(command, "--json-out", a.json_out, "Write the report as JSON", "FILE");
  add_option(command, "--plots", a.plots, "Write plots as PNG", "DIR");
  add_min_visible_option(command, a.options.min_visible_fraction);
}

}  // namespace bpa::cli
