// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa train: the score layers, from frames with truth.
#include <algorithm>
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>

#include "core/eval/matching.hpp"
#include "core/io/file_bytes.hpp"
#include "core/pipeline/score_layer_file.hpp"
#include "core/scene/interpretations.hpp"
#include "core/scene/overlaps.hpp"
#include "tools/command.hpp"
#include "tools/search.hpp"

namespace bpa::cli {
namespace {

struct TrainArguments {
  CommonOptions common;
  DetectorArguments detector;
  DatasetOptions dataset;        // without its folder
  std::vector<std::string> bop;  // folders
  std::string output, made_by = "bpa train";
  int held_out = 5;
};

struct Samples {
  std::vector<ScoreFrame> training, held_out;
};
struct AllSamples {
  Samples round_two, round_three;
};

// What round two has to order: right poses, and every fifth wrong one, none of which competes.
ScoreFrame round_two_samples(const FrameTrace& trace, const DetectorOptions& options,
                             const std::vector<io::BopInstance>& truth) {
  ScoreFrame out;
  int wrong = 0;
  for (std::size_t m = 0; m < trace.objects.size(); ++m) {
    const ObjectModel& model = *trace.models[m];
    const FeaturePlaces places(model);
    for (const TraceStage& stage : trace.objects[m].stages) {
      if (stage.name != "round_two") continue;
      for (const FastPose& fast : stage.poses) {
        const Pose pose = to_pose(fast);
        const bool right = eval::is_right_about_any(pose, model, truth);
        if (!right && wrong++ % 5 != 0) continue;
        Evidence evidence(trace.scene, places, pose, options.detect.score.quick_points);
        out.samples.push_back({measure(evidence, Round::two), right});
      }
    }
  }
  out.competition.rivals.resize(out.samples.size());
  return out;
}

// What interpretations choose from.
ScoreFrame round_three_samples(const FrameTrace& trace, const DetectorOptions& options,
                               const std::vector<io::BopInstance>& truth) {
  ScoreFrame out;
  out.competition =
      competition_of(trace.candidates, find_overlaps(trace.candidates, options.scene.max_shared));
  for (const Candidate& candidate : trace.candidates) {
    out.samples.push_back(
        {candidate.values, eval::is_right_about_any(candidate.pose(), *candidate.model, truth)});
  }
  return out;
}

// The placements of every frame as the detector chooses from them: right ones, the right object in
// a wrong pose, and wrong objects, each aligned as well as possible (paper section V).
Status collect(const TrainArguments& a, AllSamples& samples) {
  DetectorArguments built_in = a.detector;
  built_in.built_in_layers = true;
  const Result<Detector> detector = open_detector(built_in, a.common.threads);
  if (!detector.ok()) return detector.status();
  const auto use = [&](const SearchedFrame& frame) {
    const int index = static_cast<int>(frame.index);
    const bool held_out = a.held_out > 0 && index % a.held_out == a.held_out - 1;
    const auto add = [&](Samples& to, ScoreFrame scores) {
      (held_out ? to.held_out : to.training).push_back(std::move(scores));
    };
    add(samples.round_two, round_two_samples(frame.trace, detector->options(), frame.truth));
    add(samples.round_three, round_three_samples(frame.trace, detector->options(), frame.truth));
  };
  for (const std::string& folder : a.bop) {
    DatasetOptions dataset = a.dataset;
    dataset.folder = folder;
    const Status status = search_frames(*detector, dataset, a.common, use);
    if (!status.ok()) return status;
  }
  return {};
}

// Of what a layer was made.
std::string provenance(const TrainArguments& a, std::size_t frames) {
  std::string sets;
  for (const std::string& folder : a.bop) {
    sets += (sets.empty() ? "" : " and ") + folder.substr(folder.find_last_of('/') + 1);
  }
  return a.made_by + ": split " + a.dataset.split + " of " + sets + ", " + std::to_string(frames) +
         " frames, seed " + std::to_string(a.common.seed);
}

void print_reliability(const char* name, const ScoreLayer& layer,
                       const std::vector<ScoreFrame>& frames) {
  if (frames.empty()) return;
  const Reliability r = reliability(layer, frames);
  std::printf("%s: %d placements, %d right; expected calibration error %.4f, Brier score %.4f\n",
              name, r.samples, r.right, r.expected_calibration_error, r.brier_score);
  std::printf("  predicted  right  placements\n");
  for (const Reliability::Bin& bin : r.bins) {
    if (bin.count > 0) {
      std::printf("  %9.2f  %5.2f  %10d\n", bin.predicted, bin.right, bin.count);
    }
  }
}

// The same samples of frames or models that have no colour.
Samples without_color(Samples samples) {
  for (auto* frames : {&samples.training, &samples.held_out}) {
    for (ScoreFrame& frame : *frames) {
      for (auto& sample : frame.samples) sample.values[component("color")] = kNotKnown;
    }
  }
  return samples;
}

Status train(const TrainArguments& a) {
  AllSamples samples;
  if (Status status = collect(a, samples); !status.ok()) return status;
  ScoreLayers layers;
  const auto learn = [&](const char* name, const Samples& from, ScoreLayer& layer) {
    Result<ScoreLayer> learned = train_score_layer(from.training);
    if (!learned.ok()) return learned.status();
    layer = std::move(*learned);
    layer.provenance = provenance(a, from.training.size());
    std::printf("%s\n", name);
    print_reliability("training", layer, from.training);
    print_reliability("held out", layer, from.held_out);
    return Status();
  };
  struct Task {
    const char* name;
    const Samples& from;
    ScoreLayer& layer;
  };
  const Samples uncolored = without_color(samples.round_three);
  for (const Task& task : {Task{"round two", samples.round_two, layers.round_two},
                           Task{"round three", samples.round_three, layers.round_three},
                           Task{"without colours", uncolored, layers.without_color}}) {
    if (Status status = learn(task.name, task.from, task.layer); !status.ok()) return status;
  }
  const std::string path = a.output.empty() ? score_layer_path(a.detector.library) : a.output;
  if (Status status = write_score_layers(path, layers); !status.ok()) return status;
  std::printf("wrote %s\n", path.c_str());
  return {};
}

}  // namespace

void add_train_command(CLI::App& program, Action& action) {
  CLI::App& command = *program.add_subcommand(
      "train", "Learn the probability of a placement from frames with truth");
  const auto a = std::make_shared<TrainArguments>();
  add_detector_options(command, a->detector);
  command.add_option("--bop", a->bop, "Folder of a BOP data set with truth; may be repeated")
      ->required()
      ->type_name("DIR");
  add_split_options(command, a->dataset);
  command
      .add_option("--held-out", a->held_out,
                  "Keep every N-th frame out of training, to judge the layers by; 0 = none")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command
      .add_option("--output", a->output,
                  "Write the layers to this file instead of the library's score_layer.json")
      ->type_name("FILE");
  command.add_option("--made-by", a->made_by, "Command that the file's provenance names")
      ->type_name("TEXT")
      ->capture_default_str();
  add_common_options(command, a->common);
  command.callback([&action, a] { action = [a] { return train(*a); }; });
}

}  // namespace bpa::cli
