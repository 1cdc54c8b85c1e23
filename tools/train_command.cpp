// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa train: the score layers, from frames with truth.
#include <algorithm>
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>

#include "core/eval/pose_errors.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/file_bytes.hpp"
#include "core/pipeline/detector.hpp"
#include "core/pipeline/frame_trace.hpp"
#include "core/pipeline/score_layer_file.hpp"
#include "core/scene/interpretations.hpp"
#include "core/scene/overlaps.hpp"
#include "tools/command.hpp"
#include "tools/detection_files.hpp"
#include "tools/progress.hpp"

namespace bpa::cli {
namespace {

struct TrainArguments {
  CommonOptions common;
  std::string library, split = "test", config, output, made_by = "bpa train";
  std::vector<std::string> bop;
  std::vector<int> scenes;
  int held_out = 5;
};

struct Samples {
  std::vector<ScoreFrame> training, held_out;
};
struct AllSamples {
  Samples round_two, round_three;
};

bool is_right(const Pose& pose, const ObjectModel& model,
              const std::vector<io::BopInstance>& truth) {
  return std::any_of(truth.begin(), truth.end(), [&](const io::BopInstance& instance) {
    return instance.obj_id == model.number &&
           eval::is_right(pose, instance.camera_from_object, model.symmetry);
  });
}

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
        const bool right = is_right(pose, model, truth);
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
    out.samples.push_back({candidate.values, is_right(candidate.pose(), *candidate.model, truth)});
  }
  return out;
}

// What the detector would choose from: the right placements, the right object in a wrong pose, and
// wrong objects aligned as well as they can be (paper section V).
Status collect(const TrainArguments& a, const Detector& detector,
               const std::vector<io::BopFrame>& frames, AllSamples& samples) {
  DetectRequest request;
  request.seed = a.common.seed;
  request.num_threads = a.common.threads;
  Progress progress("frames", static_cast<int>(frames.size()));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    progress.show(static_cast<int>(i));
    if (!frames[i].has_truth) continue;
    Result<Frame> frame = io::load_bop_frame(frames[i]);
    if (!frame.ok()) return frame.status();
    clean_depth(*frame);
    FrameTrace trace;
    const auto result = detector.detect(*frame, request, &trace);
    if (!result.ok()) return result.status();
    const bool held_out = a.held_out > 0 && static_cast<int>(i) % a.held_out == a.held_out - 1;
    const auto add = [&](Samples& to, ScoreFrame scores) {
      (held_out ? to.held_out : to.training).push_back(std::move(scores));
    };
    add(samples.round_two, round_two_samples(trace, detector.options(), frames[i].truth));
    add(samples.round_three, round_three_samples(trace, detector.options(), frames[i].truth));
  }
  return {};
}

Status collect_all(const TrainArguments& a, AllSamples& samples) {
  DetectorOptions options;
  if (!a.config.empty()) {
    const Result<DetectorOptions> loaded = load_detector_options(a.config);
    if (!loaded.ok()) return loaded.status();
    options = *loaded;
  }
  const auto library = load_detection_library(a.library, {}, a.common.threads);
  if (!library.ok()) return library.status();
  const Detector detector(*library, options);
  for (const std::string& folder : a.bop) {
    const auto frames = io::read_bop_frames(folder, a.split, a.scenes);
    if (!frames.ok()) return frames.status();
    if (Status status = collect(a, detector, *frames, samples); !status.ok()) return status;
  }
  return {};
}

// Of what a layer was made.
std::string provenance(const TrainArguments& a, std::size_t frames) {
  std::string sets;
  for (const std::string& folder : a.bop) {
    sets += (sets.empty() ? "" : " and ") + folder.substr(folder.find_last_of('/') + 1);
  }
  return a.made_by + ": split " + a.split + " of " + sets + ", " + std::to_string(frames) +
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
  if (Status status = collect_all(a, samples); !status.ok()) return status;
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
  const std::string path = a.output.empty() ? score_layer_path(a.library) : a.output;
  if (Status status = write_score_layers(path, layers); !status.ok()) return status;
  std::printf("wrote %s\n", path.c_str());
  return {};
}

}  // namespace

void add_train_command(CLI::App& program, Action& action) {
  CLI::App& command = *program.add_subcommand(
      "train", "Learn from frames with truth how sure a placement is, for a model library");
  const auto a = std::make_shared<TrainArguments>();
  command.add_option("--library", a->library, "Folder of the model library")
      ->required()
      ->type_name("DIR");
  command.add_option("--bop", a->bop, "Folder of a BOP data set with truth; may be repeated")
      ->required()
      ->type_name("DIR");
  command.add_option("--split", a->split, "Split of the data set")
      ->type_name("NAME")
      ->capture_default_str();
  command.add_option("--scenes", a->scenes, "Scenes of the split, such as 1,4; all if not given")
      ->delimiter(',')
      ->type_name("LIST");
  command.add_option("--config", a->config, "Detector options as YAML")->type_name("FILE");
  command
      .add_option("--held-out", a->held_out,
                  "Every so many frames one is kept out of training to judge by; 0 = none")
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
