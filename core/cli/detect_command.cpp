// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa detect: frames in, ranked interpretations out.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>

#include <bpa/core/base/stopwatch.hpp>
#include <bpa/core/cli/command.hpp>
#include <bpa/core/cli/contact_sheet.hpp>
#include <bpa/core/cli/detection_files.hpp>
#include <bpa/core/cli/explain_folder.hpp>
#include <bpa/core/cli/progress.hpp>
#include <bpa/core/io/bop_dataset.hpp>
#include <bpa/core/io/camera_file.hpp>
#include <bpa/core/io/file_bytes.hpp>
#include <bpa/core/io/frame_file.hpp>
#include <bpa/core/io/pcd_file.hpp>
#include <bpa/core/pipeline/annotate.hpp>
#include <bpa/core/pipeline/detector.hpp>
#include <bpa/core/pipeline/frame_trace.hpp>
#include <bpa/core/pipeline/pose_prior_file.hpp>
#include <bpa/core/pipeline/score_layer_file.hpp>

namespace bpa::cli {
namespace {

constexpr std::size_t kWorstFrames = 6;

struct DetectArguments {
  CommonOptions common;
  std::string library, config;
  std::vector<std::string> pcd;
  std::string depth, color, camera, bop;
  std::string split = "test";
  std::string scenes, models, priors;
  std::string mask;
  std::vector<int> roi;
  int top = 20;
  double budget_ms = 0;
  std::string csv, json, annotate, explain;
};

/// A frame and where its poses are to be reported.
struct Input {
  Frame frame;
  Pose reported_from_camera;
  int scene_id = 0;
  int im_id = 0;
  bool has_truth = false;
  std::vector<io::BopInstance> truth;
};

std::string input_name(const DetectArguments& a, int scene_id, int im_id) {
  if (!a.pcd.empty()) return a.pcd[static_cast<std::size_t>(im_id)];
  if (a.bop.empty()) return a.depth;
  return "scene " + std::to_string(scene_id) + " image " + std::to_string(im_id);
}

/// For files about it.
std::string frame_name(const Input& input) {
  char name[32];
  std::snprintf(name, sizeof name, "%06d_%06d", input.scene_id, input.im_id);
  return name;
}

Result<Input> read_pcd_input(const DetectArguments& a, int index) {
  const std::string& path = a.pcd[static_cast<std::size_t>(index)];
  const Result<io::PcdCloud> cloud = io::read_pcd(path);
  if (!cloud.ok()) return cloud.status();
  Result<io::OrganisedFrame> organised = Status(StatusCode::internal, "not read");
  if (a.camera.empty()) {
    organised = io::frame_from_organised_cloud(*cloud);
  } else {
    Result<io::CameraFile> camera = io::read_camera(a.camera);
    if (!camera.ok()) return camera.status();
    if (camera->camera.width == 0) {
      camera->camera.width = cloud->width;
      camera->camera.height = cloud->height;
    }
    organised = io::frame_from_organised_cloud(*cloud, &camera->camera);
  }
  if (!organised.ok()) {
    return Status(organised.status().code, path + ": " + organised.status().message);
  }
  for (const std::string& note : organised->notes) {
    std::printf("%s: %s\n", path.c_str(), note.c_str());
  }
  Input input;
  input.im_id = index;
  input.frame = std::move(organised->frame);
  input.reported_from_camera = organised->cloud_from_camera;
  return input;
}

Result<Input> read_png_input(const DetectArguments& a) {
  const Result<io::CameraFile> camera = io::read_camera(a.camera);
  if (!camera.ok()) return camera.status();
  if (!camera->note.empty()) std::printf("%s: %s\n", a.camera.c_str(), camera->note.c_str());
  Result<Frame> frame = io::read_frame(a.depth, a.color, camera->camera, camera->depth_scale_mm);
  if (!frame.ok()) return frame.status();
  Input input;
  input.frame = std::move(*frame);
  return input;
}

Result<Input> read_bop_input(const io::BopFrame& entry) {
  Result<Frame> frame = io::load_bop_frame(entry);
  if (!frame.ok()) return frame.status();
  Input input;
  input.frame = std::move(*frame);
  input.scene_id = entry.scene_id;
  input.im_id = entry.im_id;
  input.has_truth = entry.has_truth;
  input.truth = entry.truth;
  return input;
}

void print_result(const std::string& name, const io::FrameResult& result) {
  std::printf("%s: %zu interpretation%s, %.2f s%s\n", name.c_str(), result.interpretations.size(),
              result.interpretations.size() == 1 ? "" : "s", result.seconds,
              result.budget_exhausted ? " (time budget exhausted)" : "");
  if (result.interpretations.empty() || result.interpretations.front().placements.empty()) {
    std::printf("  nothing known is there\n");
    return;
  }
  std::printf("  %-28s %5s %7s  %23s  %s\n", "model", "prob.", "visible", "x y z [m]",
              "orientation w x y z");
  for (const io::ResultPlacement& p : result.interpretations.front().placements) {
    const Eigen::Vector3d& t = p.camera_from_object.translation;
    const Eigen::Vector4d q = to_wxyz(p.camera_from_object.rotation);
    std::printf("  %-28s %5.2f %5.0f %%  %7.3f %7.3f %7.3f  %6.3f %6.3f %6.3f %6.3f\n",
                p.model.c_str(), p.probability, 100 * p.visible_fraction, t.x(), t.y(), t.z(), q[0],
                q[1], q[2], q[3]);
  }
}

/// What the caller says of every frame.
struct Given {
  RegionOfInterest roi;
  std::vector<std::uint8_t> mask;
  std::vector<PosePrior> priors;  ///< In the frame that poses are reported in.
};

Result<Given> read_given(const DetectArguments& a) {
  Given given;
  if (!a.roi.empty()) given.roi = {a.roi[0], a.roi[1], a.roi[2], a.roi[3]};
  if (!a.mask.empty()) {
    const Result<io::GrayImage> mask = io::read_gray_png(a.mask);
    if (!mask.ok()) return mask.status();
    for (const std::uint16_t value : mask->pixels) given.mask.push_back(value > 0);
  }
  if (!a.priors.empty()) {
    Result<std::vector<PosePrior>> priors = read_pose_priors(a.priors);
    if (!priors.ok()) return priors.status();
    given.priors = std::move(*priors);
  }
  return given;
}

/// Runs over the inputs and writes what was asked for.
class DetectRun {
 public:
  DetectRun(const DetectArguments& arguments, const Detector& detector, const Given& given,
            std::size_t num_frames)
      : a_(arguments), detector_(detector), given_(given) {
    if (!a_.explain.empty()) explain_.emplace(a_.explain, num_frames > 1);
    request_.models = split_commas(a_.models);
    request_.top_k = a_.top;
    request_.budget_ms = a_.budget_ms;
    request_.seed = a_.common.seed;
    request_.num_threads = a_.common.threads;
  }

  Status one(Input input) {
    const std::string name = input_name(a_, input.scene_id, input.im_id);
    clean_depth(input.frame);
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
      Status status = explain_->add({name, frame_name(input), input.frame, trace, *scene,
                                     detector_.score_layer(), input.truth});
      if (!status.ok()) return status;
    }
    return a_.annotate.empty() ? Status() : annotate_frame(input, *scene, name);
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
  Status write_sheets() const {
    std::vector<io::ColorImage> all, worst;
    for (const AnnotatedFrame& frame : sheet_) all.push_back(frame.image);
    if (all.empty()) return {};
    for (const std::size_t i : worst_first(sheet_)) {
      if (worst.size() < kWorstFrames) worst.push_back(sheet_[i].image);
    }
    const Status status =
        io::write_color_png(a_.annotate + "/contact_sheet.png", contact_sheet(all, 2, 960));
    if (!status.ok()) return status;
    return io::write_color_png(a_.annotate + "/worst_frames.png", contact_sheet(worst, 2, 960));
  }

  Status annotate_frame(const Input& input, const SceneInterpretations& scene,
                        const std::string& name) {
    if (scene.interpretations.empty()) return {};
    const Interpretation& best = scene.interpretations.front();
    const std::string file = a_.annotate + "/" + frame_name(input) + ".png";
    if (!input.has_truth) {
      return io::write_color_png(file, annotate(input.frame, best, detector_.library()));
    }
    sheet_.push_back(
        truth_beside_result(input.frame, input.truth, best, detector_.library(), name));
    return io::write_color_png(file, sheet_.back().image);
  }

  const DetectArguments& a_;
  const Detector& detector_;
  const Given& given_;
  std::optional<ExplainFolder> explain_;
  DetectRequest request_;
  std::vector<io::FrameResult> results_;
  std::vector<AnnotatedFrame> sheet_;
};

Result<std::vector<int>> parse_scenes(const std::string& list) {
  std::vector<int> scenes;
  for (const std::string& part : split_commas(list)) {
    if (part.size() > 6 || part.find_first_not_of("0123456789") != std::string::npos) {
      return invalid_argument("--scenes has \"" + part + "\"; it must be numbers and commas");
    }
    scenes.push_back(std::stoi(part));
  }
  return scenes;
}

Status run_bop(const DetectArguments& a, const Detector& detector, const Given& given) {
  const Result<std::vector<int>> scenes = parse_scenes(a.scenes);
  if (!scenes.ok()) return scenes.status();
  const Result<std::vector<io::BopFrame>> frames = io::read_bop_frames(a.bop, a.split, *scenes);
  if (!frames.ok()) return frames.status();
  DetectRun run(a, detector, given, frames->size());
  Progress progress("frames", static_cast<int>(frames->size()));
  for (std::size_t i = 0; i < frames->size(); ++i) {
    progress.show(static_cast<int>(i));
    Result<Input> input = read_bop_input((*frames)[i]);
    if (!input.ok()) return input.status();
    progress.clear();
    if (Status s = run.one(std::move(*input)); !s.ok()) return s;
  }
  return run.finish();
}

Status detect(const DetectArguments& a) {
  DetectorOptions options;
  if (!a.config.empty()) {
    const Result<DetectorOptions> loaded = load_detector_options(a.config);
    if (!loaded.ok()) return loaded.status();
    options = *loaded;
  }
  // A bad frame or folder is said before the library is loaded, which takes longer.
  Result<Input> first = Input{};
  if (!a.pcd.empty()) first = read_pcd_input(a, 0);
  if (!a.depth.empty()) first = read_png_input(a);
  if (!first.ok()) return first.status();
  const Result<Given> given = read_given(a);
  if (!given.ok()) return given.status();
  if (!a.explain.empty()) {
    if (Status s = io::make_folder(a.explain); !s.ok()) return s;
  }
  const auto library = load_detection_library(a.library, split_commas(a.models), a.common.threads);
  if (!library.ok()) return library.status();
  Result<ScoreLayer> layer = library_score_layer(a.library);
  if (!layer.ok()) return layer.status();
  const Detector detector(*library, options, std::move(*layer));
  if (!a.bop.empty()) return run_bop(a, detector, *given);
  DetectRun run(a, detector, *given, std::max<std::size_t>(1, a.pcd.size()));
  if (Status s = run.one(std::move(*first)); !s.ok()) return s;
  for (int i = 1; i < static_cast<int>(a.pcd.size()); ++i) {
    Result<Input> next = read_pcd_input(a, i);
    if (!next.ok()) return next.status();
    if (Status s = run.one(std::move(*next)); !s.ok()) return s;
  }
  return run.finish();
}

/// Usage: exactly one source of frames, and what belongs to it.
void check_usage(const DetectArguments& a) {
  const int sources = !a.pcd.empty() + !a.depth.empty() + !a.bop.empty();
  if (sources != 1) {
    throw CLI::ValidationError("frames", "give one of --pcd, --depth (with --camera) and --bop");
  }
  if (!a.depth.empty() && a.camera.empty()) {
    throw CLI::ValidationError("--depth", "needs --camera FILE");
  }
  if (a.depth.empty() && !a.color.empty()) {
    throw CLI::ValidationError("--color", "needs --depth FILE");
  }
  if (!a.bop.empty() && !a.camera.empty()) {
    throw CLI::ValidationError("--camera", "is not for --bop: the data set has its cameras");
  }
  if (a.bop.empty() && !a.scenes.empty()) throw CLI::ValidationError("--scenes", "needs --bop");
}

void add_inputs(CLI::App& command, DetectArguments& a) {
  command.add_option("--library", a.library, "Folder of the model library")
      ->required()
      ->type_name("DIR");
  command.add_option("--pcd", a.pcd, "Organised PCD clouds; the camera is estimated from them")
      ->type_name("FILE...");
  command.add_option("--depth", a.depth, "16-bit depth PNG, registered to colour")
      ->type_name("FILE");
  command.add_option("--color", a.color, "8-bit colour PNG of the same size")->type_name("FILE");
  command.add_option("--camera", a.camera, "BOP camera.json or ROS camera_info YAML")
      ->type_name("FILE");
  command.add_option("--bop", a.bop, "Folder of a BOP data set")->type_name("DIR");
  command.add_option("--split", a.split, "Split of the data set")
      ->type_name("NAME")
      ->capture_default_str();
  command.add_option("--scenes", a.scenes, "Scenes of the split, such as 1,4; all if not given")
      ->type_name("LIST");
  command.add_option("--models", a.models, "Names of models to look for; all if not given")
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
                  "What is known beforehand of the objects' poses, in the frame that they are "
                  "reported in: JSON, {\"priors\": [{\"model\": NAME, \"pose\": "
                  "{\"rotation_wxyz\": [4], \"translation_m\": [3]}, \"position_sigma_m\": S, "
                  "\"rotation_sigma_deg\": S, \"weight\": W}]}")
      ->type_name("FILE");
  command.add_option("--config", a.config, "Settings of the detector (detector.yaml)")
      ->type_name("FILE");
}

}  // namespace

void add_detect_command(CLI::App& program, Action& action) {
  CLI::App& command = *program.add_subcommand("detect", "Find objects in RGB-D frames");
  const auto a = std::make_shared<DetectArguments>();
  add_inputs(command, *a);
  command.add_option("--top", a->top, "Number of interpretations")
      ->check(CLI::Range(1, 100))
      ->type_name("K")
      ->capture_default_str();
  command.add_option("--budget-ms", a->budget_ms, "Time for a frame; 0 = no limit")
      ->check(CLI::NonNegativeNumber)
      ->type_name("T");
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
