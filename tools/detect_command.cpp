// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa detect: frames in, ranked interpretations out.
#include <cstdio>
#include <optional>
#include <set>
#include <sstream>

#include "core/base/concat.hpp"
#include "core/base/stopwatch.hpp"
#include "core/cloud/frame_fusion.hpp"
#include "core/doctor/result_check.hpp"
#include "core/draw/annotate.hpp"
#include "core/draw/sheet.hpp"
#include "core/eval/match_names.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/pose_prior_file.hpp"
#include "core/io/results.hpp"
#include "core/pipeline/views.hpp"
#include "tools/detect_views.hpp"
#include "tools/explain_folder.hpp"
#include "tools/search.hpp"

namespace bpa::cli {
namespace {

constexpr std::size_t kWorstFrames = 6;

void print_result(const std::string& name, const io::FrameResult& result) {
  std::printf("%s: %zu interpretation%s, %.2f s%s", name.c_str(), result.interpretations.size(),
              result.interpretations.size() == 1 ? "" : "s", result.seconds,
              result.budget_exhausted ? " (time budget exhausted)" : "");
  if (!result.sensor.empty() && result.sensor != name_of(SensorKind::structured_light))
    std::printf(", %s", result.sensor.c_str());
  if (result.fused_frames > 1) std::printf(", %d frames combined", result.fused_frames);
  const auto by_color = std::ranges::find(result.plan, "features.use_color", &PlanEntry::name);
  if (by_color != result.plan.end() && by_color->value == "false") {
    std::printf(", without colours (%s)", by_color->reason.c_str());
  }
  double missed = 0;
  for (const MissedModel& of_model : result.missed) missed += of_model.expected;
  if (!result.missed.empty()) std::printf(", %.2f objects missed (expected)", missed);
  std::printf("\n");
  if (result.interpretations.empty() || result.interpretations.front().placements.empty()) {
    std::printf("  nothing known is there\n");
    return;
  }
  std::printf("  %-28s %5s %5s %7s  %23s  %s\n", "model", "there", "pose", "visible", "x y z [m]",
              "orientation w x y z");
  for (const Placement& p : result.interpretations.front().placements) {
    const Eigen::Vector3d& t = p.frame_from_object.translation;
    const Eigen::Vector4d q = to_wxyz(p.frame_from_object.rotation);
    std::printf("  %-28s %5.2f %5.2f %5.0f %%  %7.3f %7.3f %7.3f  %6.3f %6.3f %6.3f %6.3f\n",
                p.model.c_str(), p.presence, p.probability, 100 * p.visible_fraction, t.x(), t.y(),
                t.z(), q[0], q[1], q[2], q[3]);
  }
}

/// What the caller says of every frame.
struct Given {
  RegionOfInterest roi;
  std::vector<std::uint8_t> mask;
  std::vector<PosePrior> priors;  ///< In the frame that poses are reported in.
};

Given read_given(const DetectArguments& a) {
  Given given;
  if (!a.roi.empty()) given.roi = {a.roi[0], a.roi[1], a.roi[2], a.roi[3]};
  if (!a.mask.empty()) {
    const io::GrayImage mask = or_throw(io::read_gray_png(a.mask));
    for (const std::uint16_t value : mask.pixels) given.mask.push_back(value > 0);
  }
  given.priors = or_throw(io::read_pose_priors(a.priors));
  return given;
}

/// The result with its poses, covariances and orientations in the frame that they are reported in.
io::FrameResult reported(const SceneInterpretations& scene, const Pose& reported_from_camera,
                         const io::BopFrame& entry, double seconds) {
  io::FrameResult result{scene, entry.scene_id, entry.im_id, seconds, {}};
  for (Interpretation& interpretation : result.interpretations) {
    for (Placement& placement : interpretation.placements) {
      placement = transformed(reported_from_camera, placement);
    }
  }
  return result;
}

DetectRequest request_of(const DetectArguments& a) {
  DetectRequest request = request_of(a.common);
  request.models = a.detector.models;
  request.top_k = a.top;
  request.budget_ms = a.budget_ms;
  return request;
}

/// The results with the data set's numbers, which alone stand in its CSV. Models that it lacks are
/// left out with a warning.
std::vector<io::FrameResult> numbered_as(const std::string& dataset,
                                         std::vector<io::FrameResult> results) {
  const auto models = io::read_bop_models(dataset);
  if (!models.ok()) return results;  // test sets may come without
  eval::ModelNames objects;
  for (const io::BopModel& model : *models) objects[model.obj_id] = model.name;
  const std::set<std::string> lacks = eval::number_by_name(objects, results);
  if (!lacks.empty()) print_warnings(dataset, {"its CSV leaves out models: " + listed(lacks)});
  return results;
}

void write_results(const DetectArguments& a, const std::vector<io::FrameResult>& results) {
  if (!a.csv.empty()) {
    const std::string& dataset = a.dataset.folder;
    or_throw(
        io::write_results_csv(a.csv, dataset.empty() ? results : numbered_as(dataset, results)));
  }
  if (!a.json.empty()) or_throw(io::write_results_json(a.json, results));
}

/// Runs over the inputs and writes what was asked for.
class DetectRun {
 public:
  DetectRun(const DetectArguments& arguments, const Detector& detector, const Given& given,
            bool several_frames)
      : a_(arguments),
        detector_(detector),
        given_(given),
        fusion_(arguments.fuse),
        request_(request_of(arguments)) {
    if (!a_.explain.empty()) explain_.emplace(a_.explain, several_frames);
  }

  /// Takes up a frame. Searches once all that are combined are there, or with a scene's `last`.
  void add(const io::BopFrame& entry, Input input, bool last) {
    if (a_.fuse > 1) {
      or_throw(validate(input.frame), input.name);
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
      if (!complete) return;
      combined_ = 0;
      fusion_ = FrameFusion(a_.fuse);
      input.frame = std::move(fused.frame);
    }
    search(entry, input);
  }

  void finish() const {
    write_results(a_, results_);
    if (explain_) explain_->finish();
    if (sheet_.empty()) return;
    std::vector<io::ColorImage> all, worst;
    for (const draw::JudgedFrame& frame : sheet_) all.push_back(frame.picture);
    for (const std::size_t i : draw::worst_first(sheet_)) {
      if (worst.size() < kWorstFrames) worst.push_back(sheet_[i].picture);
    }
    write_picture("contact_sheet", draw::contact_sheet(all, 2, 960));
    write_picture("worst_frames", draw::contact_sheet(worst, 2, 960));
  }

 private:
  void search(const io::BopFrame& entry, Input& input) {
    input.frame.roi = given_.roi;
    input.frame.mask = given_.mask;
    request_.priors.clear();
    for (const PosePrior& prior : given_.priors) {
      request_.priors.push_back(detect::transformed(input.reported_from_camera.inverse(), prior));
    }
    if (std::exchange(scene_id_, entry.scene_id) != entry.scene_id) request_.expected.clear();
    const Stopwatch watch;
    FrameTrace trace;
    const SceneInterpretations scene =
        or_throw(detector_.detect(input.frame, request_, explain_ ? &trace : nullptr), input.name);
    if (a_.follow) request_.expected = expected_after(scene);
    results_.push_back(reported(scene, input.reported_from_camera, entry, watch.seconds()));
    print_result(input.name, results_.back());
    print_advice(input.frame, scene);
    std::fflush(stdout);
    const std::string file = io::bop_number(entry.scene_id) + "_" + io::bop_number(entry.im_id);
    if (explain_) {
      explain_->add(
          {input.name, file, input.frame, trace, scene, detector_.score_layers(), entry.truth});
    }
    if (a_.annotate.empty() || scene.interpretations.empty()) return;
    write_picture(file + "_summary", draw::summary(input.frame, scene.interpretations,
                                                   detector_.library(), input.name));
    const Interpretation& best = scene.interpretations.front();
    if (!entry.has_truth) {
      return write_picture(file, draw::annotate(input.frame, best, detector_.library()));
    }
    sheet_.push_back(
        draw::truth_beside_result(input.frame, entry.truth, best, detector_.library(), input.name));
    write_picture(file, sheet_.back().picture);
  }

  /// What is wrong with a frame; the same as of another one is not said again.
  void print_advice(const Frame& frame, const SceneInterpretations& scene) {
    const double range = detector_.options().surface.max_range_m;
    const std::string advice = doctor::advice_on(frame, scene, range, a_.common.threads);
    if (advice.empty() || std::exchange(advice_, advice) == advice) return;
    std::istringstream lines(advice);
    for (std::string line; std::getline(lines, line);) std::printf("  %s\n", line.c_str());
  }

  void write_picture(const std::string& name, const io::ColorImage& picture) const {
    or_throw(io::write_color_png(a_.annotate + "/" + name + ".png", picture));
  }

  const DetectArguments& a_;
  const Detector& detector_;
  const Given& given_;
  FrameFusion fusion_;
  int combined_ = 0;    ///< Frames since the last search.
  int scene_id_ = -1;   ///< Of the frame before.
  std::string advice_;  ///< Of the last frame that had some.
  std::optional<ExplainFolder> explain_;
  DetectRequest request_;
  std::vector<io::FrameResult> results_;
  std::vector<draw::JudgedFrame> sheet_;
};

/// What CLI11 cannot say: exactly one source of frames.
void check_usage(const DetectArguments& a) {
  if (count_inputs(a) + !a.bag.empty() != 1) {
    throw CLI::ValidationError("frames",
                               "give one of --pcd, --depth (with --camera), --bop and --bag");
  }
  if (a.follow && a.dataset.folder.empty() && a.bag.empty()) {
    throw CLI::ValidationError("--follow", "needs --bop or --bag");
  }
}

/// Those that could not be searched, of all.
struct Losses {
  int failed = 0;
  int frames = 0;

  void add(const std::string& why) {
    std::fprintf(stderr, "not searched: %s\n", why.c_str());
    ++failed;
  }
};

/// Searches a recording's frames as they come, numbered from 0.
Losses search_bag(const DetectArguments& a, ros::BagFrames& bag, DetectRun& run) {
  Losses losses;
  std::optional<std::pair<io::BopFrame, Input>> held;  // whether it is the last one shows later
  const auto search = [&](bool last) {
    if (held) run.add(held->first, std::move(held->second), last);
    held.reset();
  };
  while (true) {
    auto frame = bag.next();
    if (frame.ok() && !*frame) break;
    io::BopFrame entry;
    entry.im_id = losses.frames++;
    const std::string name = concat(a.bag, " frame ", entry.im_id);
    if (frame.ok() && (*frame)->ok()) {
      search(false);
      held.emplace(entry, Input{name, std::move(**frame).value(), {}});
      continue;
    }
    losses.add(frame.ok() ? name + ": " + (*frame)->status().message : frame.status().message);
    if (!frame.ok()) break;  // the recording goes no further
  }
  search(true);
  return losses;
}

void detect(const DetectArguments& a) {
  check_usage(a);
  std::optional<ros::BagFrames> bag;
  if (!a.bag.empty()) {
    bag = or_throw(ros::BagFrames::open(a.bag, a.bag_topics, a.bag_start_s));
    std::printf("%s: %s\n", a.bag.c_str(), bag->description().c_str());
  }
  // Frames are checked before the library is loaded, which takes longer.
  std::vector<io::BopFrame> entries = bag ? std::vector<io::BopFrame>() : list_inputs(a);
  std::optional<Input> only;
  if (entries.size() == 1) only = read_input(a, entries.front());
  const Given given = read_given(a);
  if (!a.explain.empty()) or_throw(io::make_folder(a.explain));
  const Detector detector = open_detector(a.detector, a.common.threads);
  if (!a.dataset.folder.empty()) {
    number_truth(a.dataset.folder, detector.library(), a.detector.models.empty(), entries);
  }
  if (a.views > 1) {
    ViewsQuestion question{request_of(a), given.roi, given.mask};
    question.request.priors = given.priors;
    return write_results(a, detect_joined(a, entries, detector, question, print_result));
  }
  DetectRun run(a, detector, given, bag || entries.size() > 1);
  Progress progress("frames", static_cast<int>(entries.size()));
  Losses losses = bag ? search_bag(a, *bag, run) : Losses{0, static_cast<int>(entries.size())};
  for (std::size_t i = 0; i < entries.size(); ++i) {
    progress.show(static_cast<int>(i));
    const bool last = i + 1 == entries.size() || entries[i].scene_id != entries[i + 1].scene_id;
    try {
      Input input = only ? std::move(*only) : read_input(a, entries[i]);
      progress.clear();
      run.add(entries[i], std::move(input), last);
    } catch (const Failure& failure) {
      if (entries.size() == 1 || a.fuse > 1) throw;  // frames that are combined need each other
      progress.clear();
      losses.add(failure.what());
    }
  }
  run.finish();
  if (losses.failed == 0) return;
  throw Failure(
      invalid_argument(losses.failed, " of ", losses.frames, " frames could not be searched"));
}

void add_bag(CLI::App& command, DetectArguments& a) {
  auto* const bag =
      add_option(command, "--bag", a.bag,
                 "Recording of ROS 2 (rosbag2): its folder, or a .mcap or .db3 file", "PATH");
  const auto topic = [&](const char* option, std::string& name, const char* what) {
    add_option(command, option, name, what, "TOPIC")->needs(bag);
  };
  topic("--depth-topic", a.bag_topics.depth, "Its depth images; found by their type if not given");
  topic("--color-topic", a.bag_topics.color,
        "Its colour images, registered to depth; those of the depth's frame if not given");
  topic("--camera-info-topic", a.bag_topics.camera_info,
        "Its camera info; the one beside the images if not given");
  topic("--cloud-topic", a.bag_topics.cloud,
        "Its organised clouds; read where there are no depth images if not given");
  add_option(command, "--start", a.bag_start_s, "Seconds of the recording to leave out", "S")
      ->needs(bag)
      ->check(CLI::NonNegativeNumber);
}

void add_inputs(CLI::App& command, DetectArguments& a) {
  add_input_options(command, a);
  add_bag(command, a);
  add_option(command, "--fuse", a.fuse,
             "Combine the depth of N consecutive frames of a scene and search them once; camera "
             "and scene must stand still",
             "N")
      ->check(CLI::Range(1, 30));
  command.add_flag("--follow", a.follow,
                   "Frames of a scene or recording follow each other: look first for what the one "
                   "before showed");
}

void add_views(CLI::App& command, DetectArguments& a) {
  auto* const views =
      add_option(command, "--views", a.views,
                 "Join N consecutive frames of a scene that stands still, of several cameras or of "
                 "one that moved; poses are reported in the fixed frame",
                 "N")
          ->check(CLI::Range(2, static_cast<int>(kMostViews)));
  for (const char* other : {"--fuse", "--follow", "--bag"})
    views->excludes(command.get_option(other));
  add_option(command, "--poses", a.poses,
             "Where the cameras of --views are, in the order of the frames: JSON that bpa "
             "calibrate writes. cam_R_w2c of the data set if not given",
             "FILE")
      ->needs(views);
}

void add_question(CLI::App& command, DetectArguments& a) {
  add_detector_options(command, a.detector);
  add_option(command, "--models", a.detector.models,
             "Names of models to look for; all if not given", "LIST")
      ->delimiter(',');
  add_option(command, "--roi", a.roi,
             "Part of each frame that is searched: X Y WIDTH HEIGHT, pixels")
      ->expected(4);
  add_option(command, "--mask", a.mask,
             "8-bit PNG of the frames' size; where it is black, they are not searched", "FILE");
  add_option(command, "--priors", a.priors,
             "Prior poses of objects, in the frame that poses are reported in: JSON, "
             "{\"priors\": [{\"model\": NAME, \"pose\": "
             "{\"rotation_wxyz\": [4], \"translation_m\": [3]}, \"position_sigma_m\": S, "
             "\"rotation_sigma_deg\": S, \"weight\": W}]}",
             "FILE");
  command
      .add_option("--min-probability", a.detector.min_probability,
                  "Least presence of an object in the best interpretation; of the settings if not "
                  "given")
      ->check(CLI::Range(0.0, 1.0));
  add_option(command, "--top", a.top, "Number of interpretations", "K")->check(CLI::Range(1, 100));
  add_option(command, "--budget-ms", a.budget_ms, "Time for a frame; 0 = no limit", "T")
      ->check(CLI::NonNegativeNumber);
}

}  // namespace

void add_detect_command(CLI::App& program) {
  const auto [command, a] = add_command(program, "detect", "Find objects in RGB-D frames", detect);
  add_inputs(command, a);
  add_views(command, a);
  add_question(command, a);
  add_option(command, "--csv", a.csv, "Write the best interpretation as BOP CSV", "FILE");
  add_option(command, "--json", a.json, "Write all interpretations as JSON", "FILE");
  add_option(
      command, "--annotate", a.annotate,
      "Write of each frame a picture and a summary with the second interpretation; where the "
      "truth is known, also contact_sheet.png and worst_frames.png",
      "DIR");
  add_option(command, "--explain", a.explain,
             "Write pictures of each stage of the search for each frame and model. index.html "
             "has counts, times and score components",
             "DIR")
      ->excludes("--views");
}

}  // namespace bpa::cli
