// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa detect: frames in, ranked interpretations out.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>

#include "core/base/stopwatch.hpp"
#include "core/cloud/frame_fusion.hpp"
#include "core/draw/annotate.hpp"
#include "core/draw/sheet.hpp"
#include "core/draw/truth.hpp"
#include "core/io/file_bytes.hpp"
#include "tools/detect_inputs.hpp"
#include "tools/detection_files.hpp"
#include "tools/explain_folder.hpp"
#include "tools/progress.hpp"

namespace bpa::cli {
namespace {

constexpr std::size_t kWorstFrames = 6;

void print_result(const std::string& name, const io::FrameResult& result) {
  std::printf("%s: %zu interpretation%s, %.2f s%s", name.c_str(), result.interpretations.size(),
              result.interpretations.size() == 1 ? "" : "s", result.seconds,
              result.budget_exhausted ? " (time budget exhausted)" : "");
  if (result.fused_frames > 1) std::printf(", %d frames combined", result.fused_frames);
  std::printf("\n");
  if (result.interpretations.empty() || result.interpretations.front().placements.empty()) {
    std::printf("  nothing known is there\n");
    return;
  }
  std::printf("  %-28s %5s %7s  %23s  %s\n", "model", "prob.", "visible", "x y z [m]",
              "orientation w x y z");
  for (const Placement& p : result.interpretations.front().placements) {
    const Eigen::Vector3d& t = p.camera_from_object.translation;
    const Eigen::Vector4d q = to_wxyz(p.camera_from_object.rotation);
    std::printf("  %-28s %5.2f %5.0f %%  %7.3f %7.3f %7.3f  %6.3f %6.3f %6.3f %6.3f\n",
                p.model.c_str(), p.probability, 100 * p.visible_fraction, t.x(), t.y(), t.z(), q[0],
                q[1], q[2], q[3]);
  }
}

/// Runs over the inputs and writes what was asked for.
class DetectRun {
 public:
  DetectRun(const DetectArguments& arguments, const Detector& detector, const Given& given,
            std::size_t num_frames)
      : a_(arguments), detector_(detector), given_(given), fusion_(arguments.fuse) {
    if (!a_.explain.empty()) explain_.emplace(a_.explain, num_frames > 1);
    request_.models = a_.detector.models;
    request_.top_k = a_.top;
    request_.budget_ms = a_.budget_ms;
    request_.seed = a_.common.seed;
    request_.num_threads = a_.common.threads;
  }

  /// Takes up a frame. Searches once those that are to be combined are there, or with the `last`
  /// of a scene.
  Status add(Input input, bool last) {
    if (a_.fuse == 1) return search(std::move(input));
    if (Status s = validate(input.frame); !s.ok()) {
      return Status(s.code, input.name + ": " + s.message);
    }
    const bool complete = ++combined_ == a_.fuse || last;
    FusedFrame fused;
    if (complete) {
      fused = fusion_.add(std::move(input.frame), a_.common.threads);
    } else {
      fused.restart = fusion_.hold(input.frame);
    }
    if (!fused.restart.empty()) {
      std::printf("%s: not combined with those before it: %s\n", input.name.c_str(),
                  fused.restart.c_str());
    }
    if (!complete) return {};
    combined_ = 0;
    fusion_ = FrameFusion(a_.fuse);
    input.frame = std::move(fused.frame);
    return search(std::move(input));
  }

  Status finish() const {
    if (!a_.csv.empty()) {
      if (Status s = io::write_results_csv(a_.csv, results_); !s.ok()) return s;
    }
    if (!a_.json.empty()) {
      if (Status s = io::write_results_json(a_.json, results_); !s.ok()) return s;
    }
    if (explain_) {
      if (Status s = explain_->finish(); !s.ok()) return s;
    }
    return a_.annotate.empty() ? Status() : write_sheets();
  }

 private:
  Status search(Input input) {
    const std::string& name = input.name;
    input.frame.roi = given_.roi;
    input.frame.mask = given_.mask;
    request_.priors.clear();
    for (const PosePrior& prior : given_.priors) {
      request_.priors.push_back(transformed(input.reported_from_camera.inverse(), prior));
    }
    const Stopwatch watch;
    FrameTrace trace;
    const Result<SceneInterpretations> scene =
        detector_.detect(input.frame, request_, explain_ ? &trace : nullptr);
    const double seconds = watch.seconds();
    if (!scene.ok()) return Status(scene.status().code, name + ": " + scene.status().message);
    results_.push_back(
        to_frame_result(*scene, input.scene_id, input.im_id, seconds, input.reported_from_camera));
    print_result(name, results_.back());
    std::fflush(stdout);
    if (explain_) {
      Status status = explain_->add({name, file_name(input), input.frame, trace, *scene,
                                     detector_.score_layers(), input.truth});
      if (!status.ok()) return status;
    }
    return a_.annotate.empty() ? Status() : annotate_frame(input, *scene, name);
  }

  Status write_sheets() const {
    std::vector<io::ColorImage> all, worst;
    for (const draw::JudgedFrame& frame : sheet_) all.push_back(frame.picture);
    if (all.empty()) return {};
    for (const std::size_t i : draw::worst_first(sheet_)) {
      if (worst.size() < kWorstFrames) worst.push_back(sheet_[i].picture);
    }
    const Status status =
        io::write_color_png(a_.annotate + "/contact_sheet.png", draw::contact_sheet(all, 2, 960));
    if (!status.ok()) return status;
    return io::write_color_png(a_.annotate + "/worst_frames.png",
                               draw::contact_sheet(worst, 2, 960));
  }

  Status annotate_frame(const Input& input, const SceneInterpretations& scene,
                        const std::string& name) {
    if (scene.interpretations.empty()) return {};
    const Interpretation& best = scene.interpretations.front();
    const std::string file = a_.annotate + "/" + file_name(input) + ".png";
    if (!input.has_truth) {
      return io::write_color_png(file, draw::annotate(input.frame, best, detector_.library()));
    }
    sheet_.push_back(
        draw::truth_beside_result(input.frame, input.truth, best, detector_.library(), name));
    return io::write_color_png(file, sheet_.back().picture);
  }

  const DetectArguments& a_;
  const Detector& detector_;
  const Given& given_;
  FrameFusion fusion_;
  int combined_ = 0;  ///< Frames since the last search.
  std::optional<ExplainFolder> explain_;
  DetectRequest request_;
  std::vector<io::FrameResult> results_;
  std::vector<draw::JudgedFrame> sheet_;
};

Status detect(const DetectArguments& a) {
  // Frames are checked before the library is loaded, which takes longer.
  const Result<Inputs> inputs = Inputs::open(a);
  if (!inputs.ok()) return inputs.status();
  Result<Input> input = inputs->size() > 0 ? inputs->read(0) : Input{};
  if (!input.ok()) return input.status();
  const Result<Given> given = read_given(a);
  if (!given.ok()) return given.status();
  if (!a.explain.empty()) {
    if (Status s = io::make_folder(a.explain); !s.ok()) return s;
  }
  const Result<Detector> detector = open_detector(a.detector, a.common.threads);
  if (!detector.ok()) return detector.status();
  DetectRun run(a, *detector, *given, inputs->size());
  Progress progress("frames", static_cast<int>(inputs->size()));
  for (std::size_t i = 0; i < inputs->size(); ++i) {
    progress.show(static_cast<int>(i));
    if (i > 0) input = inputs->read(i);
    if (!input.ok()) return input.status();
    progress.clear();
    if (Status s = run.add(std::move(*input), inputs->ends_scene(i)); !s.ok()) return s;
  }
  return run.finish();
}

/// What CLI11 cannot say: exactly one source of frames, and one colour image for each depth image.
void check_usage(const DetectArguments& a) {
  const int sources = !a.pcd.empty() + !a.depth.empty() + !a.dataset.folder.empty();
  if (sources != 1) {
    throw CLI::ValidationError("frames", "give one of --pcd, --depth (with --camera) and --bop");
  }
  if (!a.color.empty() && a.color.size() != a.depth.size()) {
    throw CLI::ValidationError("--color", "needs as many files as --depth");
  }
}

void add_inputs(CLI::App& command, DetectArguments& a) {
  command.add_option("--pcd", a.pcd, "Organised PCD clouds; the camera is estimated from them")
      ->type_name("FILE...");
  auto* const camera =
      command.add_option("--camera", a.camera, "BOP camera.json or ROS camera_info YAML");
  camera->type_name("FILE");
  auto* const depth =
      command.add_option("--depth", a.depth, "16-bit depth PNGs, registered to colour");
  depth->needs(camera)->type_name("FILE...");
  command.add_option("--color", a.color, "8-bit colour PNGs of the same size")
      ->needs(depth)
      ->type_name("FILE...");
  auto* const bop = command.add_option("--bop", a.dataset.folder, "Folder of a BOP data set");
  bop->excludes(camera)->type_name("DIR");
  add_split_options(command, a.dataset);
  command.get_option("--scenes")->needs(bop);
  command
      .add_option(
          "--fuse", a.fuse,
          "Combine the depth of N consecutive frames of a scene and search them once; camera "
          "and scene must stand still")
      ->check(CLI::Range(1, 30))
      ->type_name("N")
      ->capture_default_str();
}

void add_question(CLI::App& command, DetectArguments& a) {
  add_detector_options(command, a.detector);
  command
      .add_option("--models", a.detector.models, "Names of models to look for; all if not given")
      ->delimiter(',')
      ->type_name("LIST");
  command
      .add_option("--roi", a.roi, "Part of each frame that is searched: X Y WIDTH HEIGHT, pixels")
      ->expected(4);
  command
      .add_option("--mask", a.mask,
                  "8-bit PNG of the frames' size; where it is black, they are not searched")
      ->type_name("FILE");
  command
      .add_option("--priors", a.priors,
                  "Prior poses of objects, in the frame that poses are reported in: JSON, "
                  "{\"priors\": [{\"model\": NAME, \"pose\": "
                  "{\"rotation_wxyz\": [4], \"translation_m\": [3]}, \"position_sigma_m\": S, "
                  "\"rotation_sigma_deg\": S, \"weight\": W}]}")
      ->type_name("FILE");
  command.add_option("--top", a.top, "Number of interpretations")
      ->check(CLI::Range(1, 100))
      ->type_name("K")
      ->capture_default_str();
  command.add_option("--budget-ms", a.budget_ms, "Time for a frame; 0 = no limit")
      ->check(CLI::NonNegativeNumber)
      ->type_name("T");
}

}  // namespace

void add_detect_command(CLI::App& program, Action& action) {
  CLI::App& command = *program.add_subcommand("detect", "Find objects in RGB-D frames");
  const auto a = std::make_shared<DetectArguments>();
  add_inputs(command, *a);
  add_question(command, *a);
  command.add_option("--csv", a->csv, "Write the best interpretation as BOP CSV")
      ->type_name("FILE");
  command.add_option("--json", a->json, "Write all interpretations as JSON")->type_name("FILE");
  command
      .add_option("--annotate", a->annotate,
                  "Write a picture of each frame and, where the truth is known, contact_sheet.png "
                  "and worst_frames.png")
      ->type_name("DIR");
  command
      .add_option("--explain", a->explain,
                  "Write pictures of what each stage of the search made of each frame and model, "
                  "with counts, times and score components; begin with index.html")
      ->type_name("DIR");
  add_common_options(command, a->common);
  command.callback([&action, a] {
    check_usage(*a);
    action = [a] { return detect(*a); };
  });
}

}  // namespace bpa::cli
