// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa bench accuracy: how many of the true placements are still alive after each stage.
#include <algorithm>
#include <cstdio>
#include <map>

#include <nlohmann/json.hpp>

#include "core/eval/pose_errors.hpp"
#include "core/io/file_bytes.hpp"
#include "tools/search.hpp"
#include "tools/search_tally.hpp"

namespace bpa::cli {
namespace {

struct AccuracyArguments {
  CommonOptions common;
  DatasetOptions dataset;
  DetectorArguments detector;
  std::string json;
  double min_visible = 0.1;
};

// For some instances: how many there were, and how many were alive after each stage.
struct Survival {
  int instances = 0;
  std::vector<int> alive;

  void add(const std::vector<bool>& flags) {
    alive.resize(std::max(alive.size(), flags.size()));
    ++instances;
    for (std::size_t i = 0; i < flags.size(); ++i) alive[i] += flags[i];
  }
};

struct Tally {
  std::vector<std::string> stages;
  std::map<std::string, Survival> by_object;
  Survival all;
  RightPlacements placements;
  StageTimes times;
  int frames = 0;
};

// The index of a model in the trace, or -1.
std::ptrdiff_t index_of(const FrameTrace& trace, int number) {
  const auto found = std::ranges::find(trace.models, number, &ObjectModel::number);
  return found == trace.models.end() ? -1 : found - trace.models.begin();
}

void add_instance(const io::BopInstance& truth, const FrameTrace& trace,
                  const SceneInterpretations& result, Tally& tally) {
  const std::ptrdiff_t m = index_of(trace, truth.obj_id);
  if (m < 0) return;
  const auto is_right = [&](const Pose& pose) {
    return eval::is_right(pose, truth.camera_from_object, trace.models[m]->symmetry);
  };
  const auto holds_it = [&](const Interpretation& interpretation) {
    return holds(interpretation, truth, *trace.models[m]);
  };
  tally.stages.clear();
  std::vector<bool> alive;
  for (const detect::TraceStage& stage : trace.objects[m].stages) {
    tally.stages.emplace_back(stage.name);
    alive.push_back(std::ranges::any_of(stage.poses, is_right, to_pose));
  }
  tally.stages.insert(tally.stages.end(), {"best 20", "best"});
  alive.push_back(std::ranges::any_of(result.interpretations, holds_it));
  alive.push_back(holds_it(result.interpretations.front()));
  tally.all.add(alive);
  tally.by_object[io::bop_object_name(truth.obj_id)].add(alive);
}

void print_row(const std::string& name, const Survival& survival) {
  std::printf("%-18s %5d", name.c_str(), survival.instances);
  for (int count : survival.alive) {
    std::printf("  %9.1f %%", 100.0 * count / std::max(1, survival.instances));
  }
  std::printf("\n");
}

void print_tally(const Tally& tally) {
  std::printf("Instances for which a right pose (2.5 cm, pi/16, modulo symmetry) is alive after\n");
  std::printf("%-18s %5s", "object", "all");
  for (const std::string& stage : tally.stages) std::printf("  %11s", stage.c_str());
  std::printf("\n");
  for (const auto& [name, survival] : tally.by_object) print_row(name, survival);
  print_row("all", tally.all);
  std::printf("best interpretation: %d of %d reported are right\n", tally.placements.reported.hits,
              tally.placements.reported.total);
  std::printf(
      "mean milliseconds a frame (stages of objects summed over models, on one core each)\n");
  for (const auto& [stage, milliseconds] : tally.times.means()) {
    std::printf("  %-22s %9.1f\n", stage.c_str(), milliseconds);
  }
}

nlohmann::json to_json(const Tally& tally) {
  const auto survival = [&](const Survival& s) {
    nlohmann::json out = {{"instances", s.instances}};
    for (std::size_t i = 0; i < s.alive.size(); ++i) out[tally.stages[i]] = s.alive[i];
    return out;
  };
  nlohmann::json objects, times;
  for (const auto& [name, s] : tally.by_object) objects[name] = survival(s);
  for (const auto& [stage, milliseconds] : tally.times.means()) times[stage] = milliseconds;
  return {{"experiment", "bpa bench accuracy"},
          {"frames", tally.frames},
          {"alive", survival(tally.all)},
          {"objects", objects},
          {"reported", tally.placements.reported.total},
          {"right", tally.placements.reported.hits},
          {"mean_milliseconds", times}};
}

void bench_accuracy(const AccuracyArguments& a) {
  const Detector detector = open_detector(a.detector, a.common.threads);
  Tally tally;
  search_frames(
      detector, a.dataset, a.common,
      [&](const TrueFrame& frame, const SceneInterpretations& result, const FrameTrace& trace) {
        ++tally.frames;
        for (const io::BopInstance& instance : frame.truth) {
          if (instance.visible_fraction < a.min_visible) continue;
          add_instance(instance, trace, result, tally);
        }
        tally.placements.add(frame.truth, result, detector.library(), a.min_visible);
        tally.times.add(result, trace);
      });
  print_tally(tally);
  if (!a.json.empty()) or_throw(io::write_file(a.json, to_json(tally).dump(2) + "\n"));
}

}  // namespace

void add_bench_accuracy(CLI::App& bench) {
  const auto [command, a] = add_command(
      bench, "accuracy", "The stages of the detector that lose true placements, by object",
      bench_accuracy);
  add_dataset_options(command, a.dataset);
  add_detector_options(command, a.detector);
  add_min_visible_option(command, a.min_visible);
  add_option(command, "--json", a.json, "Write the table as JSON", "FILE");
}

}  // namespace bpa::cli
