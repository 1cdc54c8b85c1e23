// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa train: the score layer, from frames with truth.
#include <algorithm>
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>

#include <bpa/core/cli/command.hpp>
#include <bpa/core/cli/detection_files.hpp>
#include <bpa/core/cli/progress.hpp>
#include <bpa/core/eval/pose_errors.hpp>
#include <bpa/core/io/bop_dataset.hpp>
#include <bpa/core/io/file_bytes.hpp>
#include <bpa/core/pipeline/detector.hpp>
#include <bpa/core/pipeline/frame_trace.hpp>
#include <bpa/core/pipeline/score_layer_file.hpp>
#include <bpa/core/scene/interpretations.hpp>
#include <bpa/core/scene/overlaps.hpp>

namespace bpa::cli {
namespace {

struct TrainArguments {
  CommonOptions common;
  std::string library, bop, split = "test", config, source;
  std::vector<int> scenes;
  int held_out = 5;
};

struct Samples {
  std::vector<ScoreFrame> training, held_out;
};

bool is_right(const Candidate& candidate, const std::vector<io::BopInstance>& truth) {
  return std::any_of(truth.begin(), truth.end(), [&](const io::BopInstance& instance) {
    return instance.obj_id == candidate.model->number &&
           eval::is_right(candidate.pose(), instance.camera_from_object, candidate.model->symmetry);
  });
}

// What the detector would choose from: the right placements, the right object in a wrong pose, and
// wrong objects aligned as well as they can be (paper section V).
Status collect(const TrainArguments& a, Samples& samples) {
  DetectorOptions options;
  if (!a.config.empty()) {
    const Result<DetectorOptions> loaded = load_detector_options(a.config);
    if (!loaded.ok()) return loaded.status();
    options = *loaded;
  }
  const auto library = load_detection_library(a.library, {}, a.common.threads);
  if (!library.ok()) return library.status();
  const auto frames = io::read_bop_frames(a.bop, a.split, a.scenes);
  if (!frames.ok()) return frames.status();
  const Detector detector(*library, options);
  DetectRequest request;
  request.seed = a.common.seed;
  request.num_threads = a.common.threads;
  Progress progress("frames", static_cast<int>(frames->size()));
  for (std::size_t i = 0; i < frames->size(); ++i) {
    progress.show(static_cast<int>(i));
    if (!(*frames)[i].has_truth) continue;
    Result<Frame> frame = io::load_bop_frame((*frames)[i]);
    if (!frame.ok()) return frame.status();
    clean_depth(*frame);
    FrameTrace trace;
    const auto result = detector.detect(*frame, request, &trace);
    if (!result.ok()) return result.status();
    ScoreFrame scores;
    scores.competition =
        competition_of(trace.candidates, find_overlaps(trace.candidates, kMaxShared));
    for (const Candidate& candidate : trace.candidates) {
      scores.samples.push_back(
          {score_features(candidate.components), is_right(candidate, (*frames)[i].truth)});
    }
    const bool held_out = a.held_out > 0 && static_cast<int>(i) % a.held_out == a.held_out - 1;
    (held_out ? samples.held_out : samples.training).push_back(std::move(scores));
  }
  return {};
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

std::string list(std::span<const double> values) {
  std::string out;
  char number[32];
  for (double value : values) {
    std::snprintf(number, sizeof number, "%s%.6g", out.empty() ? "{" : ", ", value);
    out += number;
  }
  return out + "}";
}

// A C++ source that defines default_score_layer().
std::string as_source(const ScoreLayer& layer) {
  std::string out =
      "// SPDX-FileCopyrightText: 2026 The bpa authors\n"
      "// SPDX-License-Identifier: Apache-2.0\n"
      "// Written by 'bpa train --source' (tests/accuracy/train.sh); see the provenance below.\n"
      "#include <bpa/core/score/score_layer.hpp>\n\nnamespace bpa {\n\n"
      "// clang-format off\nconst ScoreLayer& default_score_layer() {\n"
      "  static const ScoreLayer layer = {{{\n";
  char line[256];
  for (std::size_t i = 0; i < kNumScoreFeatures; ++i) {
    const ScoreLayer::Component& c = layer.components[i];
    out += std::string("      // ") + score_feature_names()[i] + "\n      {" + list(c.place) +
           ",\n       " + list(c.value) + "},\n";
  }
  std::snprintf(line, sizeof line, "  }}, %.9g,\n", layer.bias);
  out += line;
  out += "  \"" + layer.provenance +
         "\"};\n  return layer;\n}\n// clang-format on\n\n}  // namespace bpa\n";
  return out;
}

Status train(const TrainArguments& a) {
  Samples samples;
  if (Status status = collect(a, samples); !status.ok()) return status;
  Result<ScoreLayer> layer = train_score_layer(samples.training);
  if (!layer.ok()) return layer.status();
  layer->provenance =
      "bpa train, split " + a.split + " of " + a.bop.substr(a.bop.find_last_of('/') + 1) + ", " +
      std::to_string(samples.training.size()) + " frames, seed " + std::to_string(a.common.seed);
  print_reliability("training", *layer, samples.training);
  print_reliability("held out", *layer, samples.held_out);
  if (!a.source.empty()) return io::write_file(a.source, as_source(*layer));
  const std::string path = score_layer_path(a.library);
  if (Status status = write_score_layer(path, *layer); !status.ok()) return status;
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
  command.add_option("--bop", a->bop, "Folder of a BOP data set with truth")
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
      .add_option("--source", a->source,
                  "Write the layer as the C++ source of the built-in one, not to the library")
      ->type_name("FILE");
  add_common_options(command, a->common);
  command.callback([&action, a] { action = [a] { return train(*a); }; });
}

}  // namespace bpa::cli
