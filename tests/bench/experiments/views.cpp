// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa-experiments views: what more views of one scene find, with exact and with wrong camera poses.
#include "core/pipeline/views.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include <nlohmann/json.hpp>

#include "core/base/concat.hpp"
#include "core/base/random.hpp"
#include "core/eval/evaluation.hpp"
#include "core/io/file_bytes.hpp"
#include "tests/bench/experiments/experiments.hpp"
#include "tools/search.hpp"

namespace bpa::cli {
namespace {

struct ViewsArguments {
  CommonOptions common;
  DatasetOptions dataset;
  DetectorArguments detector;
  std::vector<int> counts{1, 2, 3, 4};
  std::vector<double> independence;
  double position_error = 0.005, angle_error_deg = 0.5;
  double min_visible = 0.1;
  std::string json;
};

using Frames = std::vector<io::BopFrame>;

// What is measured of one number of views.
struct Row {
  int views = 0;
  bool exact = true;
  double independence = 0;
  int scenes = 0;
  eval::Ratio precision, recall;              // visible in any of the views that are used
  eval::Ratio recall_of_all;                  // visible in any view of the scene
  std::vector<double> position_m, angle_deg;  // of right placements
  std::vector<double> gap_m, gap_deg;         // between cameras, as the surfaces say
  int warned = 0, pairs = 0;
  double brier = 0, log_loss = 0;  // sums over placements
  int judged = 0;
  std::vector<double> squares;  // normalised squared errors of poses, per degree of freedom
  std::array<eval::ReliabilityBin, 10> bins{};
  double milliseconds = 0;
};

// The instances of a scene in the fixed frame; each is as visible as in the view that sees most.
std::vector<io::BopInstance> truth_of(const Frames& frames, std::size_t views) {
  constexpr double kSame_m = 0.02;  // truth of different images differs by their rounding
  std::vector<io::BopInstance> out;
  for (std::size_t v = 0; v < views; ++v) {
    std::vector<bool> taken(out.size(), false);
    const Pose scene_from_camera = frames[v].camera_from_world->inverse();
    for (io::BopInstance instance : frames[v].truth) {
      instance.camera_from_object = scene_from_camera * instance.camera_from_object;
      std::size_t k = 0;
      while (k < taken.size() &&
             (taken[k] || out[k].obj_id != instance.obj_id ||
              (out[k].camera_from_object.translation - instance.camera_from_object.translation)
                      .norm() > kSame_m)) {
        ++k;
      }
      if (k == taken.size()) {
        out.push_back(instance);
        continue;
      }
      taken[k] = true;
      out[k].visible_fraction = std::max(out[k].visible_fraction, instance.visible_fraction);
    }
  }
  return out;
}

// A camera's pose that is off by so much, in random directions.
Pose disturbed(const Pose& scene_from_camera, const ViewsArguments& a, int scene,
               std::size_t view) {
  RandomStream random(a.common.seed, 1000 * static_cast<std::uint64_t>(scene) + view);
  const auto direction = [&random] {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return Eigen::Vector3d(Eigen::Vector3d(x, y, z).normalized());
  };
  const Eigen::Vector3d shift = a.position_error * direction();
  const Eigen::Vector3d turn = a.angle_error_deg / kDegrees * direction();
  return {(rotation_from_vector(turn) * scene_from_camera.rotation).normalized(),
          scene_from_camera.translation + shift};
}

void add_placements(const eval::FrameOutcome& outcome, const std::vector<Placement>& placements,
                    const std::vector<io::BopInstance>& truth, const eval::EvalObjects& objects,
                    Row& row) {
  for (std::size_t e = 0; e < placements.size(); ++e) {
    const eval::EstimateOutcome& estimate = outcome.estimates[e];
    if (estimate.ignored) continue;
    const bool right = estimate.truth >= 0;
    const double p = std::clamp(estimate.probability, 1e-6, 1 - 1e-6);
    row.precision.hits += right;
    ++row.precision.total;
    ++row.judged;
    row.brier += (p - right) * (p - right);
    row.log_loss -= std::log(right ? p : 1 - p);
    eval::ReliabilityBin& bin = row.bins[std::min(9, static_cast<int>(10 * p))];
    bin.mean_probability += p;
    bin.correct.hits += right;
    ++bin.correct.total;
    if (!right) continue;
    const PoseError error =
        pose_error(placements[e].frame_from_object, truth[estimate.truth].camera_from_object,
                   objects.at(estimate.obj_id).symmetry);
    row.position_m.push_back(error.position);
    row.angle_deg.push_back(error.angle * kDegrees);
    if (!estimate.covariance_error) continue;
    row.squares.push_back(estimate.covariance_error->squared /
                          estimate.covariance_error->degrees_of_freedom);
  }
}

void add_scene(const ViewsArguments& a, const Frames& frames, const eval::EvalObjects& objects,
               const ViewsResult& result, Row& row) {
  const auto views = static_cast<std::size_t>(row.views);
  io::BopFrame frame;
  frame.truth = truth_of(frames, views);
  eval::EvaluationOptions options;
  options.bop_errors = false;
  options.min_visible_fraction = a.min_visible;
  const io::FrameResult found{result.scene, 0, 0, 0, {}};
  const auto outcome = or_throw(eval::evaluate_frame(frame, objects, &found, options));
  ++row.scenes;
  for (const eval::TruthOutcome& truth : outcome.truth) {
    row.recall.total += truth.counts;
    row.recall.hits += truth.counts && truth.found;
  }
  if (!result.scene.interpretations.empty()) {
    add_placements(outcome, result.scene.interpretations.front().placements, frame.truth, objects,
                   row);
  }
  frame.truth = truth_of(frames, frames.size());
  const auto of_all = or_throw(eval::evaluate_frame(frame, objects, &found, options));
  for (const eval::TruthOutcome& truth : of_all.truth) {
    row.recall_of_all.total += truth.counts;
    row.recall_of_all.hits += truth.counts && truth.found;
  }
  for (const calibration::SurfaceDisagreement& pair : result.disagreements) {
    row.gap_m.push_back(pair.position_m);
    row.gap_deg.push_back(pair.angle_rad * kDegrees);
  }
  row.warned += static_cast<int>(result.warnings.size());
  row.pairs += static_cast<int>(result.disagreements.size());
  row.milliseconds += result.scene.total_milliseconds;
}

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const auto last = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(std::lround(part * last))];
}

double calibration_error(const Row& row) {
  double sum = 0;
  for (const eval::ReliabilityBin& bin : row.bins) {
    sum += std::abs(bin.mean_probability - bin.correct.hits);
  }
  return sum / std::max(1, row.judged);
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / std::max<double>(1, static_cast<double>(values.size()));
}

void print_rows(const std::vector<Row>& rows) {
  std::printf("%5s %6s %5s %6s  %-16s %-16s %-16s %13s %13s %6s %6s %6s %5s  %13s %13s %8s\n",
              "views", "poses", "indep", "scenes", "precision", "recall", "recall of all",
              "mm 50/95 %", "deg 50/95 %", "Brier", "logl", "ECE", "NEES", "gap mm 50/95",
              "gap deg 50/95", "warned");
  for (const Row& row : rows) {
    const auto ratio = [](const eval::Ratio& r) {
      char text[32];
      std::snprintf(text, sizeof text, "%d/%d %.1f %%", r.hits, r.total, 100 * r.value());
      return std::string(text);
    };
    const double judged = std::max(1, row.judged);
    std::printf(
        "%5d %6s %5.2f %6d  %-16s %-16s %-16s %6.1f %6.1f %6.2f %6.2f %6.3f %6.3f %6.3f %5.2f  "
        "%6.1f %6.1f %6.2f %6.2f %4d/%d\n",
        row.views, row.exact ? "exact" : "wrong", row.independence, row.scenes,
        ratio(row.precision).c_str(), ratio(row.recall).c_str(), ratio(row.recall_of_all).c_str(),
        1000 * quantile(row.position_m, 0.5), 1000 * quantile(row.position_m, 0.95),
        quantile(row.angle_deg, 0.5), quantile(row.angle_deg, 0.95), row.brier / judged,
        row.log_loss / judged, calibration_error(row), mean(row.squares),
        1000 * quantile(row.gap_m, 0.5), 1000 * quantile(row.gap_m, 0.95),
        quantile(row.gap_deg, 0.5), quantile(row.gap_deg, 0.95), row.warned, row.pairs);
  }
}

nlohmann::json to_json(const ViewsArguments& a, const std::vector<Row>& rows) {
  nlohmann::json out = {{"experiment", "bpa-experiments views"},
                        {"position_error_m", a.position_error},
                        {"angle_error_deg", a.angle_error_deg},
                        {"min_visible", a.min_visible}};
  const auto ratio = [](const eval::Ratio& r) { return nlohmann::json{r.hits, r.total}; };
  for (const Row& row : rows) {
    out["rows"].push_back(
        {{"views", row.views},
         {"exact", row.exact},
         {"independence", row.independence},
         {"scenes", row.scenes},
         {"precision", ratio(row.precision)},
         {"recall", ratio(row.recall)},
         {"recall_of_all", ratio(row.recall_of_all)},
         {"position_m", {quantile(row.position_m, 0.5), quantile(row.position_m, 0.95)}},
         {"angle_deg", {quantile(row.angle_deg, 0.5), quantile(row.angle_deg, 0.95)}},
         {"brier", row.brier / std::max(1, row.judged)},
         {"log_loss", row.log_loss / std::max(1, row.judged)},
         {"expected_calibration_error", calibration_error(row)},
         {"normalised_square", mean(row.squares)},
         {"gap_m", {quantile(row.gap_m, 0.5), quantile(row.gap_m, 0.95)}},
         {"gap_deg", {quantile(row.gap_deg, 0.5), quantile(row.gap_deg, 0.95)}},
         {"warned_pairs", {row.warned, row.pairs}},
         {"mean_milliseconds", row.milliseconds / std::max(1, row.scenes)}});
  }
  return out;
}

// Scenes whose images all have a camera's pose and truth, with as many images as are asked for.
std::vector<Frames> scenes_of(const ViewsArguments& a) {
  const auto most = static_cast<std::size_t>(std::ranges::max(a.counts));
  std::map<int, Frames> by_scene;
  const auto frames =
      or_throw(io::read_bop_frames(a.dataset.folder, a.dataset.split, a.dataset.scenes));
  for (const io::BopFrame& frame : frames) {
    Frames& scene = by_scene[frame.scene_id];
    if (frame.has_truth && frame.camera_from_world && scene.size() < most) scene.push_back(frame);
  }
  std::vector<Frames> out;
  for (auto& [id, scene] : by_scene) {
    if (scene.size() == most) out.push_back(std::move(scene));
  }
  if (out.empty()) {
    throw Failure(invalid_argument(
        concat(a.dataset.folder, " has no scene with truth and cam_R_w2c of ", most, " images")));
  }
  return out;
}

std::vector<Row> rows_of(const ViewsArguments& a, const DetectorOptions& options) {
  std::vector<Row> rows;
  for (const double independence :
       a.independence.empty() ? std::vector{options.views.independence} : a.independence) {
    for (const int count : a.counts) {
      for (const bool exact : {true, false}) {
        Row& row = rows.emplace_back();
        row.views = count;
        row.exact = exact;
        row.independence = independence;
      }
    }
  }
  return rows;
}

void bench_views(const ViewsArguments& a) {
  const std::vector<Frames> scenes = scenes_of(a);
  const Detector detector = open_detector(a.detector, a.common.threads);
  const eval::EvalObjects objects = or_throw(eval::load_eval_objects(a.dataset.folder));
  std::vector<Row> rows = rows_of(a, detector.options());
  const auto library = std::make_shared<ModelLibrary>(detector.library());
  const DetectRequest request = request_of(a.common);
  Progress progress("scenes", static_cast<int>(scenes.size()));
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    progress.show(static_cast<int>(s));
    std::vector<ViewSearch> searches;
    std::vector<const ViewSearch*> views;
    for (const io::BopFrame& entry : scenes[s]) {
      Frame frame = or_throw(io::load_bop_frame(entry));
      clean_depth(frame);
      searches.push_back(or_throw(search_view(detector, frame, request), frame.frame_id));
    }
    for (const ViewSearch& search : searches) views.push_back(&search);
    for (Row& row : rows) {
      DetectorOptions options = detector.options();
      options.views.independence = row.independence;
      const Detector joining(library, options, detector.score_layers());
      std::vector<Pose> poses;
      for (int v = 0; v < row.views; ++v) {
        const Pose pose = scenes[s][v].camera_from_world->inverse();
        poses.push_back(row.exact ? pose : disturbed(pose, a, scenes[s][v].scene_id, v));
      }
      add_scene(a, scenes[s], objects,
                combine_views(joining, std::span(views).first(row.views), poses, request), row);
    }
  }
  progress.clear();
  print_rows(rows);
  if (!a.json.empty()) or_throw(io::write_file(a.json, to_json(a, rows).dump(2) + "\n"));
}

}  // namespace

void add_views_experiment(CLI::App& program) {
  const auto [command, a] =
      add_command(program, "views",
                  "Precision, recall and pose errors of several views of one scene", bench_views);
  add_dataset_options(command, a.dataset);
  add_detector_options(command, a.detector);
  add_min_visible_option(command, a.min_visible);
  add_option(command, "--counts", a.counts, "Numbers of views: the first images of each scene",
             "LIST")
      ->delimiter(',')
      ->check(CLI::Range(1, static_cast<int>(kMostViews)));
  add_option(command, "--independence", a.independence,
             "Values of views.independence to compare; that of --config if not given", "LIST")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1.0));
  add_option(command, "--position-error", a.position_error,
             "Error of wrong camera positions, metres", "M")
      ->check(CLI::Range(0.0, 1.0));
  add_option(command, "--angle-error-deg", a.angle_error_deg,
             "Error of wrong camera orientations, degrees", "DEG")
      ->check(CLI::Range(0.0, 90.0));
  add_option(command, "--json", a.json, "Write the table as JSON", "FILE");
}

}  // namespace bpa::cli
