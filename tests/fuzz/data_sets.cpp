// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// BOP data sets, cameras, results, tracks and pose priors.
#include <cmath>

#include "core/io/bop_dataset.hpp"
#include "core/io/camera_file.hpp"
#include "core/io/camera_poses_file.hpp"
#include "core/io/image_file.hpp"
#include "core/io/pose_prior_file.hpp"
#include "core/io/results.hpp"
#include "core/io/tracks.hpp"
#include "tests/fuzz/target.hpp"

namespace bpa::fuzz {
namespace {

void run_camera(std::string_view bytes) {
  const auto file = io::read_camera(file_of(bytes, "camera"));
  if (!file.ok()) return;
  require(file->camera.fx > 0 && std::isfinite(file->camera.fy),
          "a camera's focal length is legal");
}

std::vector<std::string> camera_seeds() {
  return {R"({"fx": 525, "fy": 526, "cx": 319.5, "cy": 239, "width": 640, "height": 480,
  "depth_scale": 0.1})",
          R"({"cam_K": [525, 0, 319.5, 0, 526, 239.5, 0, 0, 1]})",
          R"({"a": {"intrinsic_matrix": [[525, 0, 0], [0, 526, 0], [319.5, 239.5, 1]]}})",
          "525 0 319.5\n0 526 239.5\n0 0 1\n",
          "image_width: 640\nimage_height: 480\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
          "  data: [525, 0, 319.5, 0, 526, 239.5, 0, 0, 1]\ndistortion_coefficients:\n"
          "  data: [0.1, 0, 0, 0, 0]\ndepth_scale: 1\n"};
}

void run_camera_poses(std::string_view bytes) {
  const auto cameras = io::read_camera_poses(file_of(bytes, "cameras.json"));
  if (!cameras.ok()) return;
  for (const io::CameraPose& camera : *cameras) {
    require(is_valid(camera.scene_from_camera), "a camera's pose is a rigid motion");
  }
}

std::vector<std::string> camera_poses_seeds() {
  return {R"({"cameras": [{"name": "left", "scene_from_camera": {"rotation_wxyz": [1, 0, 0, 0],
  "translation_m": [0.1, 0.2, 0.9]}}, {"scene_from_camera": {"rotation_wxyz": [0, 0, 1, 0],
  "translation_m": [0, 0, 0]}}]})"};
}

void run_results_json(std::string_view bytes) {
  const auto results = io::read_results_json(file_of(bytes, "results.json"));
  if (!results.ok()) return;
  for (const io::FrameResult& frame : *results) (void)io::result_json_line(frame);
}

std::vector<std::string> results_json_seeds() {
  return {R"({"format": "bpa results", "version": 1, "frames": [{"scene_id": 2, "im_id": 5,
  "seconds": 0.1, "timings": [{"stage": "edges", "milliseconds": 12.5}], "sensor": "tof",
  "effort": {"rounds": 4}, "interpretations": [{"rank": 1, "score": 2.5, "probability": 0.5,
  "placements": [{"obj_id": 3, "model": "cup", "pose": {"rotation_wxyz": [1, 0, 0, 0],
  "translation_m": [0.1, 0.2, 0.9]}, "bingham": {"axes": [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1],
  "concentrations": [-3, -2, -1]}, "score": -1.25, "probability": 0.9, "visible_fraction": 0.3,
  "components": {"range": 0.5}, "alternatives": [{"pose": {"rotation_wxyz": [1, 0, 0, 0],
  "translation_m": [0.1, 0.2, 0.9]}, "weight": 0.25}]}]}]}]})",
          R"({"format": "bpa results", "version": 1, "frames": [{"scene_id": 0, "im_id": 0,
  "seconds": 0, "interpretations": [], "frame_id": "camera", "stamp_ns": 7, "status": "busy",
  "message": "later", "queue_position": 1}]})"};
}

void run_results_csv(std::string_view bytes) {
  const auto results = io::read_results_csv(file_of(bytes, "results.csv"));
  if (!results.ok()) return;
  for (const io::FrameResult& frame : *results) {
    require(frame.interpretations.size() == 1, "a row has one interpretation");
  }
}

std::vector<std::string> results_csv_seeds() {
  return {
      "scene_id,im_id,obj_id,score,R,t,time\n2,5,3,0.9,1 0 0 0 1 0 0 0 1,10 20 900,0.1\n"
      "2,5,4,1e-3,1 0 0 0 1 0 0 0 1,-10 20 900,-1\r\n"};
}

void run_tracks_json(std::string_view bytes) {
  const auto tracks = io::read_tracks_json(file_of(bytes, "tracks.json"));
  if (!tracks.ok()) return;
  for (const io::TrackResult& frame : *tracks) (void)io::track_json_line(frame);
}

std::vector<std::string> tracks_json_seeds() {
  return {R"({"format": "bpa tracks", "version": 1, "frames": [{"scene_id": 2, "im_id": 5,
  "stamp_ns": 7, "frame_id": "map", "in_fixed_frame": true, "milliseconds": 12.5,
  "frame_from_camera": {"rotation_wxyz": [1, 0, 0, 0], "translation_m": [0, 0, 1]},
  "tracks": [{"id": 3, "name": "cup_1", "obj_id": 3, "model": "cup", "state": "occluded",
  "probability": 0.9, "pose": {"rotation_wxyz": [1, 0, 0, 0], "translation_m": [0.1, 0.2, 0.9]},
  "velocity": [0.1, 0, 0], "age_s": 2, "held": true, "weight": 0.75, "alternatives": [{"pose":
  {"rotation_wxyz": [0, 1, 0, 0], "translation_m": [0.1, 0.2, 0.9]}, "weight": 0.25}]}],
  "ended": [{"id": 2, "name": "cup_0", "reason": "not seen for 5 s"}]}]})"};
}

void run_pose_priors(std::string_view bytes) {
  (void)io::read_pose_priors(file_of(bytes, "priors.json"));
}

std::vector<std::string> pose_priors_seeds() {
  return {R"({"priors": [{"model": "mug", "weight": 0.5, "pose": {"rotation_wxyz": [0.6, 0, 0.8, 0],
  "translation_m": [0.1, 0.2, 0.7]}, "position_sigma_m": 0.02, "rotation_sigma_deg": 9}]})",
          R"({"priors": [{"model": "mug", "pose": {"translation_m": [0, 0, 1]},
  "position_covariance_m2": [1, 0, 0, 0, 1, 0, 0, 0, 1], "bingham":
  {"axes": [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1], "concentrations": [-3, -2, -1]}}]})"};
}

void run_bop_models(std::string_view bytes) {
  const std::string path = file_of(bytes, "models/models_info.json");
  (void)io::read_bop_models_folder(path.substr(0, path.rfind('/')));
}

std::vector<std::string> bop_models_seeds() {
  return {R"({"7": {"name": "cup", "diameter": 123, "min_x": 0, "size_x": 50,
  "symmetries_discrete": [[-1, 0, 0, 1, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1]],
  "symmetries_continuous": [{"axis": [0, 0.6, 0.8], "offset": [10, 20, 30]}]},
  "8": {"diameter": 80}})"};
}

/// scene_camera.json, scene_gt.json and scene_gt_info.json, one after the other, with lines "---"
/// between them. Two of the scene's depth images are there.
void run_bop_scene(std::string_view bytes) {
  const std::string scene = "bop/test/000001/";
  static const std::string depth = [&] {
    const std::string path = file_of("", scene + "depth/000005.png");
    (void)io::write_gray_png(path, {2, 1, {1, 2}});
    return path;
  }();
  for (const char* name : {"scene_camera.json", "scene_gt.json", "scene_gt_info.json"}) {
    const std::size_t end = std::min(bytes.find("\n---\n"), bytes.size());
    file_of(bytes.substr(0, end), scene + name);
    bytes.remove_prefix(std::min(end + 5, bytes.size()));
  }
  const std::string dataset = depth.substr(0, depth.find("/test/"));
  const auto frames = io::read_bop_frames(dataset, "test");
  if (!frames.ok()) return;
  for (const io::BopFrame& frame : *frames) (void)io::load_bop_frame(frame);
}

std::vector<std::string> bop_scene_seeds() {
  return {R"({"5": {"cam_K": [525, 0, 1, 0, 526, 1, 0, 0, 1], "depth_scale": 0.1,
  "stamp_ns": 1700000000033333333, "cam_R_w2c": [1, 0, 0, 0, 1, 0, 0, 0, 1],
  "cam_t_w2c": [0, 0, 800]}}
---
{"5": [{"obj_id": 7, "instance_id": 2, "cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [0, 0, 800]}]}
---
{"5": [{"visib_fract": 0.5}]})"};
}

}  // namespace

std::vector<Target> data_set_targets() {
  const char* const bop = "core/io/bop_dataset.cpp";
  const char* const results = "core/io/results.cpp";
  return {
      {"camera_file", "core/io/camera_file.cpp", run_camera, camera_seeds, 2048},
      {"results_json", results, run_results_json, results_json_seeds},
      {"results_csv", results, run_results_csv, results_csv_seeds, 2048},
      {"tracks_json", "core/io/tracks.cpp", run_tracks_json, tracks_json_seeds},
      {"camera_poses", "core/io/camera_poses_file.cpp", run_camera_poses, camera_poses_seeds, 4096},
      {"pose_priors", "core/io/pose_prior_file.cpp", run_pose_priors, pose_priors_seeds, 4096},
      {"bop_models", bop, run_bop_models, bop_models_seeds, 4096},
      {"bop_scene", bop, run_bop_scene, bop_scene_seeds, 4096}};
}

}  // namespace bpa::fuzz
