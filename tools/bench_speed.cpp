// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa bench speed: what the search finds in how much time, and what more models cost.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>

#include "core/base/concat.hpp"
#include "core/base/median.hpp"
#include "core/base/parallel.hpp"
#include "core/base/stopwatch.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/model_file.hpp"
#include "tools/process_meter.hpp"
#include "tools/search.hpp"
#include "tools/search_tally.hpp"
#include "tools/shape_library.hpp"
#include "tools/speed_report.hpp"

namespace bpa::cli {
namespace {

struct SpeedArguments {
  CommonOptions common;
  DatasetOptions dataset;
  DetectorArguments detector;
  std::vector<double> budgets = {0.1, 0.25, 0.5, 1, 2, 0};  // seconds; 0: none
  std::vector<int> model_counts = {5, 21, 50, 100, 200};
  double min_visible = 0.1;
  std::string json, plot;
};

/// The library's models, those of the data set's truth first, then made shapes.
struct RankedModels {
  std::vector<int> numbers;
  std::vector<std::string> names;
  int in_truth = 0;

  int size() const { return static_cast<int>(names.size()); }
  /// The true placements of the models that are here.
  std::vector<ExpectedPlacement> placements(const std::vector<io::BopInstance>& truth) const {
    std::vector<ExpectedPlacement> placements;
    for (const io::BopInstance& instance : truth) {
      const auto number = std::ranges::find(numbers, instance.obj_id);
      if (number == numbers.end()) continue;
      placements.push_back({names[number - numbers.begin()], instance.camera_from_object});
    }
    return placements;
  }
  /// The models that are truly in a frame, and the first of the others, `count` in all.
  std::vector<std::string> of_frame(const std::vector<io::BopInstance>& truth, int count) const {
    std::vector<std::string> there, others;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool is_there = std::ranges::count(truth, numbers[i], &io::BopInstance::obj_id) > 0;
      (is_there ? there : others).push_back(names[i]);
    }
    for (std::size_t i = 0; i < others.size() && std::ssize(there) < count; ++i) {
      there.push_back(others[i]);
    }
    return there;
  }
};

RankedModels rank_models(const std::string& library, const std::set<int>& true_numbers) {
  std::map<int, std::string> names;
  for (const std::string& name : io::list_models(library)) {
    names[or_throw(io::describe_model(library, name)).number] = name;
  }
  if (names.empty()) or_throw(io::load_library(library));  // which says why
  RankedModels ranked;
  for (const bool of_truth : {true, false}) {
    for (const auto& [number, name] : names) {
      if (true_numbers.contains(number) != of_truth) continue;
      ranked.numbers.push_back(number);
      ranked.names.push_back(name);
    }
    if (of_truth) ranked.in_truth = ranked.size();
  }
  return ranked;
}

/// Adds made shapes until there are `count` models.
void add_shapes(const SpeedArguments& a, int count, RankedModels& ranked) {
  const int missing = count - ranked.size();
  if (missing <= 0) return;
  if (a.detector.further.empty()) {
    std::printf("The library has %d models; no more are searched for. --shapes DIR adds some.\n",
                ranked.size());
    return;
  }
  for (const auto& [number, name] : complete_shape_library(a.detector.further, missing, a.common)) {
    ranked.numbers.push_back(number);
    ranked.names.push_back(name);
  }
}

/// What is truly in a data set.
struct TrueObjects {
  int frames = 0;         // that have truth
  std::set<int> numbers;  // of models
};

TrueObjects true_objects(const DatasetOptions& dataset) {
  TrueObjects truth;
  for (const auto& frame :
       or_throw(io::read_bop_frames(dataset.folder, dataset.split, dataset.scenes))) {
    truth.frames += frame.has_truth;
    for (const io::BopInstance& instance : frame.truth) truth.numbers.insert(instance.obj_id);
  }
  if (truth.frames == 0) {
    throw Failure(not_found(dataset.folder, "/", dataset.split,
                            " has no frame with truth; bpa bench speed needs scene_gt.json"));
  }
  return truth;
}

/// Searches of some frames, and what they cost.
class Measurement {
 public:
  explicit Measurement(const SpeedArguments& arguments) : a_(arguments) {}

  void search(const Detector& detector, const TrueFrame& frame, const DetectRequest& request) {
    // The first search reads mapped files and does not count.
    if (milliseconds_.empty()) or_throw(detector.detect(frame.frame, request));
    const double cpu = cpu_seconds();
    const auto result = or_throw(detector.detect(frame.frame, request));
    cpu_seconds_ += cpu_seconds() - cpu;
    milliseconds_.push_back(result.total_milliseconds);
    effort_ += result.effort;
    plan_ = result.plan;
    placements_.add(frame.truth, result, detector.library(), a_.min_visible);
  }

  int frames() const { return static_cast<int>(milliseconds_.size()); }

  /// Adds what was measured to a row of the report.
  void write(SpeedReport& row) const {
    row["right"] = placements_.reported.hits;
    row["reported"] = placements_.reported.total;
    row["found"] = placements_.found.hits;
    row["found_in_twenty"] = placements_.found_in_twenty.hits;
    row["instances"] = placements_.found.total;
    std::vector<double> times = milliseconds_;
    row["median_ms"] = median(times);
    row["max_ms"] = std::ranges::max(milliseconds_);
    row["cpu_s"] = cpu_seconds_ / frames();
    for (const auto& [name, count] : kEffortCounts) {
      row[name] = static_cast<double>(effort_.*count) / frames();
    }
    for (const auto& [name, value, reason] : plan_)
      row["plan"][name] = {{"value", value}, {"why", reason}};
  }

 private:
  const SpeedArguments& a_;
  RightPlacements placements_;
  std::vector<double> milliseconds_;
  double cpu_seconds_ = 0;
  SearchEffort effort_;
  std::vector<PlanEntry> plan_;  // of the last frame
};

/// Searches all frames, for `models` of each; 0: all of the detector.
void measure(const SpeedArguments& a, const Detector& detector, double budget_s, int models,
             const RankedModels& ranked, SpeedReport& row) {
  DetectRequest request = request_of(a.common);
  request.budget_ms = 1000 * budget_s;
  Measurement measurement(a);
  read_true_frames(a.dataset, [&](const TrueFrame& frame) {
    if (models > 0) request.models = ranked.of_frame(frame.truth, models);
    measurement.search(detector, frame, request);
  });
  measurement.write(row);
}

SpeedReport measure_stages(const SpeedArguments& a, const Detector& detector) {
  StageTimes times;
  search_frames(detector, a.dataset, a.common,
                [&](const TrueFrame&, const SceneInterpretations& result, const FrameTrace& trace) {
                  times.add(result, trace);
                });
  SpeedReport stages = SpeedReport::object();
  for (const auto& [stage, milliseconds] : times.means()) stages[stage] = milliseconds;
  return stages;
}

/// The same with the true poses given beforehand, which are aligned and scored as any other: what
/// is not found then is lost to look-alikes and scores, the rest to the search.
int found_when_given(const SpeedArguments& a, const Detector& detector, int models,
                     const RankedModels& ranked) {
  DetectRequest request = request_of(a.common);
  RightPlacements placements;
  read_true_frames(a.dataset, [&](const TrueFrame& frame) {
    request.models = ranked.of_frame(frame.truth, models);
    request.expected = ranked.placements(frame.truth);
    placements.add(frame.truth, or_throw(detector.detect(frame.frame, request)), detector.library(),
                   a.min_visible);
  });
  return placements.found.hits;
}

/// Loads as many models as are searched for, or as the truth has, and searches.
SpeedReport measure_models(const SpeedArguments& a, int count, const RankedModels& ranked) {
  const int loaded = std::max(count, ranked.in_truth);
  DetectorArguments arguments = a.detector;
  arguments.models.assign(ranked.names.begin(), ranked.names.begin() + loaded);
  const bool peak_is_known = reset_peak_memory();
  const Stopwatch watch;
  const Detector detector = open_detector(arguments, a.common.threads);
  SpeedReport row = {{"models", count}, {"loaded", loaded}, {"load_ms", watch.milliseconds()}};
  row["peak_memory_mb"] = nullptr;
  measure(a, detector, 0, count, ranked, row);
  if (const auto peak = peak_memory_mb(); peak && peak_is_known) row["peak_memory_mb"] = *peak;
  row["found_when_given"] = found_when_given(a, detector, count, ranked);
  return row;
}

/// The numbers of models to search for, in order.
std::vector<int> possible_counts(std::vector<int> wanted, int most) {
  std::ranges::sort(wanted);
  for (int& count : wanted) count = std::min(count, most);
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  return wanted;
}

void bench_speed(const SpeedArguments& a) {
  std::error_code error;  // of folders that are not there yet
  if (std::filesystem::equivalent(a.detector.library, a.detector.further, error)) {
    throw Failure(invalid_argument("--shapes is the library itself; it must be another folder"));
  }
  const TrueObjects truth = true_objects(a.dataset);
  SpeedReport report = empty_speed_report();
  report["bpa"] = BPA_VERSION;
  report["cpu"] = cpu_name();
  report["dataset"] = std::filesystem::absolute(a.dataset.folder).lexically_normal().filename();
  report["threads"] = resolve_num_threads(a.common.threads);
  report["seed"] = a.common.seed;
  report["frames"] = truth.frames;
  report["budgets"] = report["models"] = SpeedReport::array();
  RankedModels ranked = rank_models(a.detector.library, truth.numbers);
  if (ranked.in_truth < std::ssize(truth.numbers)) {
    std::printf("The library has %d of the %zu models of the truth.\n", ranked.in_truth,
                truth.numbers.size());
  }
  add_shapes(a, std::ranges::max(a.model_counts), ranked);
  // The smallest number is first: memory that is free again is still there.
  for (const int count : possible_counts(a.model_counts, ranked.size())) {
    report["models"].push_back(measure_models(a, count, ranked));
  }
  const Detector detector = open_detector(a.detector, a.common.threads);
  for (const double budget_s : a.budgets) {
    SpeedReport row = {{"budget_s", budget_s > 0 ? SpeedReport(budget_s) : SpeedReport()}};
    measure(a, detector, budget_s, 0, ranked, row);
    report["budgets"].push_back(row);
  }
  report["stages_ms"] = measure_stages(a, detector);
  print_speed_report(report);
  if (!a.json.empty()) or_throw(io::write_file(a.json, report.dump(1) + "\n"));
  if (!a.plot.empty()) plot_recall_over_time(a.plot, report);
}

}  // namespace

void add_bench_speed(CLI::App& bench) {
  const auto [command, a] = add_command(
      bench, "speed", "Recall and time by time budget, time and memory by number of models",
      bench_speed);
  add_dataset_options(command, a.dataset);
  add_detector_options(command, a.detector);
  add_min_visible_option(command, a.min_visible);
  add_option(command, "--budgets", a.budgets, "Time budgets of a frame, seconds; 0 = none", "LIST")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber);
  add_option(command, "--model-counts", a.model_counts,
             "Numbers of models to search for; those truly in a frame always, the first others of "
             "the library, then those of --shapes",
             "LIST")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  add_option(command, "--shapes", a.detector.further,
             "Library of simulated shapes that make up for what the library has too few of; made "
             "where they are not there yet, about a second a model",
             "DIR");
  add_option(command, "--json", a.json, "Write the report as JSON", "FILE");
  add_option(command, "--plot", a.plot, "Write recall over time as PNG", "FILE");
}

}  // namespace bpa::cli
