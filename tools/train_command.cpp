// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa train: the score layers, from frames with truth.
#include <cmath>
#include <cstdio>

#include "core/base/concat.hpp"
#include "core/base/random.hpp"
#include "core/eval/pose_errors.hpp"
#include "core/io/file_bytes.hpp"
#include "core/pipeline/detector.hpp"
#include "core/scene/given_others.hpp"
#include "core/scene/interpretations.hpp"
#include "core/scene/overlaps.hpp"
#include "tools/command.hpp"
#include "tools/search.hpp"
#include "tools/yield.hpp"

namespace bpa::cli {
namespace {

using Folders = std::vector<std::string>;

struct TrainArguments {
  CommonOptions common;
  DetectorArguments detector;
  DatasetOptions dataset;                                                  // without its folder
  Folders bop, all_models_bop, round_two_bop, color_bop, calibration_bop;  // see the options
  std::vector<std::string> only;
  std::string output, made_by = "bpa train";
  int held_out = 5, models_per_frame = 0;
  bool adapt = false;
};

struct Samples {
  std::vector<score::ScoreFrame> training, held_out;
};

// What round two has to order: right poses, and every fifth wrong one, none of which competes.
score::ScoreFrame round_two_samples(const FrameTrace& trace,
                                    const std::vector<io::BopInstance>& truth) {
  score::ScoreFrame out;
  int wrong = 0;
  for (std::size_t m = 0; m < trace.objects.size(); ++m) {
    const ObjectModel& model = *trace.models[m];
    const score::FeaturePlaces places(model);
    for (const detect::TraceStage& stage : trace.objects[m].stages) {
      if (stage.name != "round_two") continue;
      for (const FastPose& fast : stage.poses) {
        const Pose pose = to_pose(fast);
        const bool right = eval::is_right_about_any(pose, model, truth);
        if (!right && wrong++ % 5 != 0) continue;
        score::Evidence evidence(trace.scene, places, pose, detect::kQuickPoints);
        out.samples.push_back({measure(evidence, score::Round::two), right});
      }
    }
  }
  out.competition.rivals.resize(out.samples.size());
  return out;
}

double exposure_of(const SceneFeatures& scene, const ObjectModel& model, const Pose& pose) {
  const score::FeaturePlaces places(model);
  return score::Evidence(scene, places, pose).colors().exposure;
}

// The objects of the frame that a first interpretation would hold: most of those in sight.
detect::Candidates others_of(const Detector& detector, const FrameTrace& trace,
                             const TrueFrame& frame) {
  constexpr double kFound = 0.75;       // of the objects in sight: about the recall in unseen piles
  constexpr std::size_t kInSight = 50;  // explained pixels, chosen by hand
  const auto& models = detector.library().models();
  RandomStream random(frame.index);
  detect::Candidates out;
  for (const io::BopInstance& instance : frame.truth) {
    const auto model =
        std::ranges::find(models, instance.obj_id, [](const auto& m) { return m->number; });
    const bool found = random.uniform() < kFound;
    if (model == models.end() || !found) continue;
    detect::Candidate other{.model = model->get()};
    other.refinement.frame_from_object = instance.camera_from_object;
    other.explained = score::explained_pixels(trace.scene.image, **model, other.pose());
    other.values[score::component("exposure")] = exposure_of(trace.scene, **model, other.pose());
    if (other.explained.size() >= kInSight) out.push_back(std::move(other));
  }
  return out;
}

// Measures the candidates given what is in the frame: most of its objects.
void measure_given_truth(const Detector& detector, const FrameTrace& trace, const TrueFrame& frame,
                         double competing, int num_threads, detect::Candidates& all) {
  const std::size_t count = all.size();
  std::ranges::move(others_of(detector, trace, frame), std::back_inserter(all));
  scene::Present present(count, 0);
  present.resize(all.size(), 1);
  scene::measure_given_others(trace.scene, scene::find_overlaps(all, competing), present, all,
                              competing, num_threads);
  all.resize(count);
}

// What interpretations choose from. In a frame that is searched for all models, the others are
// those found. Where it is searched for some models alone, they are taken from the truth.
score::ScoreFrame round_three_samples(const Detector& detector, const FrameTrace& trace,
                                      const TrueFrame& frame, bool all_models, int num_threads) {
  const double competing = (*detector.score_layers().limits.at(
      detector.options().detect.score.keep_right, true))[score::Limit::competing];
  detect::Candidates all = trace.candidates;
  if (!all_models) measure_given_truth(detector, trace, frame, competing, num_threads, all);
  score::ScoreFrame out;
  out.competition = scene::competition_of(all, scene::find_overlaps(all, competing));
  for (const detect::Candidate& candidate : all) {
    out.samples.push_back({candidate.values, eval::is_right_about_any(
                                                 candidate.pose(), *candidate.model, frame.truth)});
  }
  return out;
}

// The placements of every frame as the detector chooses from them: right ones, the right object in
// a wrong pose, and wrong objects, each aligned as well as possible (paper section V).
void collect(const TrainArguments& a, const Detector& detector, const Folders& folders,
             int models_per_frame, Samples* round_two, Samples* round_three) {
  const auto use = [&](const TrueFrame& frame, const auto&, const FrameTrace& trace) {
    const int index = static_cast<int>(frame.index);
    const bool held_out = !a.adapt && a.held_out > 0 && index % a.held_out == a.held_out - 1;
    const auto part = held_out ? &Samples::held_out : &Samples::training;
    if (round_two) (round_two->*part).push_back(round_two_samples(trace, frame.truth));
    if (round_three) {
      (round_three->*part)
          .push_back(
              round_three_samples(detector, trace, frame, models_per_frame == 0, a.common.threads));
    }
  };
  for (const std::string& folder : folders) {
    DatasetOptions dataset = a.dataset;
    dataset.folder = folder;
    search_frames(detector, dataset, a.common, use, models_per_frame);
  }
}

std::vector<std::string> learned_components() {
  std::vector<std::string> out;
  for (const score::ComponentType& type : score::kScoreComponents) {
    if (type.learned) out.emplace_back(type.name);
  }
  return out;
}

// Of what a layer was made.
std::string provenance(const TrainArguments& a, const Folders& folders, std::size_t frames) {
  std::string sets;
  for (const std::string& folder : folders) {
    sets += (sets.empty() ? "" : " and ") + folder.substr(folder.find_last_of('/') + 1);
  }
  return a.made_by + ": split " + a.dataset.split + " of " + sets + ", " + std::to_string(frames) +
         " frames, seed " + std::to_string(a.common.seed);
}

void print_reliability(const char* name, const score::ScoreLayer& layer,
                       const std::vector<score::ScoreFrame>& frames) {
  if (frames.empty()) return;
  const score::Reliability r = reliability(layer, frames);
  std::printf("%s: %d placements, %d right; expected calibration error %.4f, Brier score %.4f\n",
              name, r.samples, r.right, r.expected_calibration_error, r.brier_score);
  std::printf("  predicted  right  placements\n");
  for (const score::Reliability::Bin& bin : r.bins) {
    if (bin.count > 0) {
      std::printf("  %9.2f  %5.2f  %10d\n", bin.predicted, bin.right, bin.count);
    }
  }
}

// The same samples of models without colour, in frames that have what is needed, and no more.
Samples without_color(Samples samples, score::Needs known) {
  for (auto* frames : {&samples.training, &samples.held_out}) {
    for (score::ScoreFrame& frame : *frames) {
      for (auto& sample : frame.samples) {
        for (std::size_t i = 0; i < score::kScoreComponents.size(); ++i) {
          if (score::kScoreComponents[i].needs > known) sample.values[i] = score::kNotKnown;
        }
      }
    }
  }
  return samples;
}

// Sums over frames that a layer has not seen.
struct Judged {
  double log_loss = 0;
  int reported = 0, right = 0;  // of the probabilities from 0.5, the default threshold

  void add(const score::ScoreLayer& layer, const std::vector<score::ScoreFrame>& frames) {
    const score::Reliability r = reliability(layer, frames);
    log_loss += r.log_loss * r.samples;
    for (std::size_t b = 5; b < r.bins.size(); ++b) {
      reported += r.bins[b].count;
      right += static_cast<int>(std::lround(r.bins[b].right * r.bins[b].count));
    }
  }
};

// The built-in layer adjusted to the frames, where that helps: each fifth of the frames is judged
// by what the others teach.
score::ScoreLayer adapt(const char* name, const score::ScoreLayer& built_in,
                        const std::string& made_of, const std::vector<score::ScoreFrame>& frames) {
  constexpr std::size_t kParts = 5;
  Judged before, after;
  for (std::size_t part = 0; part < kParts; ++part) {
    std::vector<score::ScoreFrame> others, left_out;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      (i % kParts == part ? left_out : others).push_back(frames[i]);
    }
    before.add(built_in, left_out);
    after.add(or_throw(score::adapt_score_layer(built_in, others)), left_out);
  }
  std::printf(
      "%s, on frames left out: log loss %.1f built in, %.1f adapted; right of those over 0.5: "
      "%d/%d built in, %d/%d adapted\n",
      name, before.log_loss, after.log_loss, before.right, before.reported, after.right,
      after.reported);
  if (after.log_loss >= before.log_loss) {
    std::printf("%s: these frames do not improve the built-in layer; it is kept\n", name);
    return built_in;
  }
  score::ScoreLayer layer = or_throw(score::adapt_score_layer(built_in, frames));
  layer.provenance = built_in.provenance + "; adapted by " + made_of;
  return layer;
}

score::ScoreLayer learn(const TrainArguments& a, const char* name, const Folders& folders,
                        const score::ScoreLayer& built_in, const Samples& samples) {
  const std::string made_of = provenance(a, folders, samples.training.size());
  if (a.adapt) return adapt(name, built_in, made_of, samples.training);
  score::ScoreLayer layer = or_throw(score::train_score_layer(samples.training));
  layer.provenance = made_of;
  std::printf("%s\n", name);
  print_reliability("training", layer, samples.training);
  print_reliability("held out", layer, samples.held_out);
  return layer;
}

// What the layer says of frames as they are in use, as often as it says.
score::ScoreLayer calibrate(const TrainArguments& a, const char* name,
                            const score::ScoreLayer& layer, const Samples& samples) {
  score::ScoreLayer out = or_throw(score::calibrate_score_layer(layer, samples.training));
  out.provenance += "; calibrated by " + provenance(a, a.calibration_bop, samples.training.size());
  std::printf("%s, calibrated\n", name);
  print_reliability("before", layer, samples.training);
  print_reliability("after", out, samples.training);
  print_reliability("held out", out, samples.held_out);
  return out;
}

Folders together(Folders folders, const Folders& more) {
  folders.insert(folders.end(), more.begin(), more.end());
  return folders;
}

// The frames that limits and yields are measured on: those of use, if any are given.
std::vector<DatasetOptions> frames_in_use(const TrainArguments& a) {
  std::vector<DatasetOptions> out;
  for (const std::string& folder : a.calibration_bop.empty() ? a.bop : a.calibration_bop) {
    out.push_back(a.dataset);
    out.back().folder = folder;
  }
  return out;
}

int models_in_use(const TrainArguments& a) {
  return a.calibration_bop.empty() ? a.models_per_frame : 0;
}

score::RightPlacement right_placement(const detect::Candidate& candidate,
                                      const score::ScoreLayer& layer) {
  score::RightPlacement out{candidate.lowest};
  out.lowest.note(score::Limit::competing, candidate.score);
  double log_odds = layer.bias + candidate.prior;
  for (std::size_t i = 0; i < score::kScoreComponents.size(); ++i) {
    log_odds += layer.components[i].at(candidate.values[i]);
    out.components[i] = static_cast<float>(log_odds);
  }
  return out;
}

score::ScoreLayers learn_all(const TrainArguments& a, const Detector& detector,
                             const score::ScoreLayers& start) {
  Samples round_two, round_three;
  const Folders kinds = together(a.bop, a.all_models_bop);
  collect(a, detector, a.bop, a.models_per_frame, &round_two, &round_three);
  collect(a, detector, a.all_models_bop, 0, &round_two, &round_three);
  collect(a, detector, a.round_two_bop, a.models_per_frame, &round_two, nullptr);
  score::ScoreLayers layers = start;
  layers.round_two =
      learn(a, "round two", together(kinds, a.round_two_bop), start.round_two, round_two);
  layers.without_color = learn(a, "without colours", kinds, start.without_color,
                               without_color(round_three, score::Needs::depth));
  if (!a.adapt) {
    score::ScoreLayer& layer = layers.without_color;
    const auto is_outline = [](const auto& type) { return type.needs == score::Needs::outline; };
    layer = or_throw(score::extend_score_layer(
        layer, is_outline, without_color(round_three, score::Needs::outline).training));
    layer.provenance += "; outlines after that, from the same frames";
  }
  collect(a, detector, a.color_bop, a.models_per_frame, nullptr, &round_three);
  layers.round_three =
      learn(a, "round three", together(kinds, a.color_bop), start.round_three, round_three);
  return layers;
}

// The layers with new curves of some components; all else stays.
score::ScoreLayers learn_only(const TrainArguments& a, const Detector& detector,
                              const score::ScoreLayers& start) {
  Samples samples;
  collect(a, detector, a.bop, a.models_per_frame, nullptr, &samples);
  collect(a, detector, a.all_models_bop, 0, nullptr, &samples);
  const auto is_new = [&a](const score::ComponentType& type) {
    return std::ranges::find(a.only, type.name) != a.only.end();
  };
  score::ScoreLayers layers = start;
  const std::string how = concat("; ", listed(a.only), " after that by ");
  const auto extend = [&](const char* name, score::ScoreLayer& layer, const Samples& seen) {
    std::printf("%s\n", name);
    print_reliability("before", layer, seen.training);
    layer = or_throw(score::extend_score_layer(layer, is_new, seen.training));
    const std::string sets = provenance(a, together(a.bop, a.all_models_bop), seen.training.size());
    layer.provenance = layer.provenance.substr(0, layer.provenance.find(how)) + how + sets;
    print_reliability("after", layer, seen.training);
    print_reliability("held out", layer, seen.held_out);
  };
  extend("round three", layers.round_three, samples);
  extend("without colours", layers.without_color, without_color(samples, score::Needs::outline));
  return layers;
}

// The placements that end right in a search without limits of frames as they are in use: the best
// of each instance.
std::vector<score::RightPlacement> right_placements(
    const TrainArguments& a, const std::shared_ptr<const ModelLibrary>& library,
    const score::ScoreLayers& layers, bool colored) {
  DetectorOptions options = read_detector_options(a.detector.config);
  options.detect.score.keep_right = 1;
  options.detect.score.stop_early = false;
  options.features.use_color = colored;
  const Detector detector(library, options, layers);
  const score::ScoreLayer& layer = colored ? layers.round_three : layers.without_color;
  std::vector<score::RightPlacement> out;
  const auto use = [&](const TrueFrame& frame, const auto&, const FrameTrace& trace) {
    if (colored && frame.frame.color.empty()) return;
    for (const io::BopInstance& instance : frame.truth) {
      const detect::Candidate* best = nullptr;
      for (const detect::Candidate& candidate : trace.candidates) {
        const bool is_best = best == nullptr || candidate.score > best->score;
        if (is_best && eval::is_right_about_any(candidate.pose(), *candidate.model, {instance})) {
          best = &candidate;
        }
      }
      if (best != nullptr) out.push_back(right_placement(*best, layer));
    }
  };
  for (const DatasetOptions& dataset : frames_in_use(a)) {
    search_frames(detector, dataset, a.common, use, models_in_use(a));
  }
  return out;
}

score::LearnedYield learn_yield(const TrainArguments& a,
                                const std::shared_ptr<const ModelLibrary>& library,
                                const score::ScoreLayers& layers) {
  score::LearnedYield out = layers.yield;
  out.provenance = concat(a.made_by, ", seed ", a.common.seed);
  for (const bool colored : {true, false}) {
    DetectorOptions options = read_detector_options(a.detector.config);
    options.features.use_color = colored;
    score::SearchYield& yield = colored ? out.with_color : out.without_color;
    yield =
        search_yield(library, options, layers, frames_in_use(a), a.common, models_in_use(a), yield);
    std::printf(
        "yield %s colours: undiscovered after t tries: (1 + t / %.2f)^-%.2f; %.0f %% of a surface "
        "in sight; %.1f objects in a scene\n",
        colored ? "with" : "without", yield.tries, yield.shape, 100 * yield.visible,
        yield.objects / yield.scenes);
  }
  return out;
}

score::LearnedLimits learn_limits(const TrainArguments& a,
                                  const std::shared_ptr<const ModelLibrary>& library,
                                  const score::ScoreLayers& layers) {
  const auto with_color = right_placements(a, library, layers, true);
  const auto without_color = right_placements(a, library, layers, false);
  score::LearnedLimits limits = score::measure_limits(with_color, without_color, layers.limits);
  limits.provenance =
      concat(a.made_by, ": ", with_color.size(), " right placements with colours and ",
             without_color.size(), " without, seed ", a.common.seed);
  const double keep_right = detect::ScoreOptions().keep_right;
  const score::Limits colored = *limits.at(keep_right, true), plain = *limits.at(keep_right, false);
  std::printf("limits of log odds that keep %g of the right placements\n", keep_right);
  std::printf("  %-18s with colours  without\n", "");
  for (std::size_t i = 0; i < score::kLimits; ++i) {
    std::printf("  %-18s %12.2f  %7.2f\n", std::string(score::kLimitNames[i]).c_str(),
                colored.stages[i], plain.stages[i]);
  }
  return limits;
}

void check_usage(const TrainArguments& a) {
  if (!a.bop.empty()) return;
  const bool learns =
      a.adapt || !a.all_models_bop.empty() || !a.round_two_bop.empty() || !a.color_bop.empty();
  if (learns || a.calibration_bop.empty()) {
    throw CLI::ValidationError(
        "--bop",
        "give frames to learn from, or --calibration-bop alone to calibrate the built-in "
        "layers");
  }
}

void write(const TrainArguments& a, const score::ScoreLayers& layers) {
  const std::string path = a.output.empty() ? score_layer_path(a.detector.library) : a.output;
  or_throw(write_score_layers(path, layers));
  std::printf("wrote %s\n", path.c_str());
}

void train(const TrainArguments& a) {
  check_usage(a);
  const auto library = open_library(a.detector, a.common.threads);
  DetectorOptions options = read_detector_options(a.detector.config);
  options.detect.score.stop_early = false;
  score::ScoreLayers layers = a.only.empty() ? score::default_score_layers()
                                             : or_throw(library_score_layers(a.detector.library));
  const Detector detector(library, options, layers);
  if (!a.only.empty()) {
    write(a, learn_only(a, detector, layers));
    return;
  }
  if (!a.bop.empty()) layers = learn_all(a, detector, layers);
  if (!a.calibration_bop.empty()) {
    Samples in_use;
    collect(a, detector, a.calibration_bop, 0, nullptr, &in_use);
    layers.round_three = calibrate(a, "round three", layers.round_three, in_use);
    layers.without_color = calibrate(a, "without colours", layers.without_color,
                                     without_color(in_use, score::Needs::depth));
  }
  layers.limits = learn_limits(a, library, layers);
  layers.yield = learn_yield(a, library, layers);
  write(a, layers);
}

}  // namespace

void add_train_command(CLI::App& program) {
  const auto [command, a] = add_command(
      program, "train", "Learn the probability of a placement from frames with truth", train);
  add_detector_options(command, a.detector);
  add_option(command, "--bop", a.bop, "Folder of a BOP data set with truth; may be repeated",
             "DIR");
  add_option(
      command, "--all-models-bop", a.all_models_bop,
      "The same, but each frame is searched for all models, whatever --models-per-frame says: "
      "bins, where wrong models find surface everywhere",
      "DIR");
  add_option(command, "--round-two-bop", a.round_two_bop,
             "Data sets that only the layer of round two learns from, which orders placements",
             "DIR");
  add_option(command, "--color-bop", a.color_bop,
             "Data sets that only the layer for colours learns from, such as objects that only "
             "their print tells apart",
             "DIR");
  add_option(
      command, "--calibration-bop", a.calibration_bop,
      "Data sets like the frames of use, searched for all models: the layers are scaled and "
      "shifted until probabilities agree with frequencies there. Without --bop, the built-in "
      "layers are",
      "DIR");
  add_split_options(command, a.dataset);
  add_option(command, "--held-out", a.held_out,
             "Keep every N-th frame out of training, to judge the layers by; 0 = none")
      ->check(CLI::Range(0, 1000));
  add_option(command, "--models-per-frame", a.models_per_frame,
             "Random models that each frame is searched for; 0 = all")
      ->check(CLI::Range(0, 1000));
  command.add_flag(
      "--adapt", a.adapt,
      "Adjust the built-in layers to these frames, where that helps on frames left out; without "
      "it, learn new layers");
  add_option(command, "--only", a.only,
             "Learn the curves of these score components anew; all else of the library's layers, "
             "or of the built-in ones, stays",
             "LIST")
      ->delimiter(',')
      ->check(CLI::IsMember(learned_components()))
      ->excludes("--adapt")
      ->excludes("--round-two-bop")
      ->excludes("--color-bop")
      ->excludes("--calibration-bop");
  add_option(command, "--output", a.output,
             "Write the layers to this file instead of the library's score_layer.json", "FILE");
  add_option(command, "--made-by", a.made_by, "Command that the file's provenance names", "TEXT");
}

}  // namespace bpa::cli
