// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/detect_views.hpp"

#include "core/base/concat.hpp"
#include "core/base/stopwatch.hpp"
#include "core/draw/annotate.hpp"
#include "core/io/camera_poses_file.hpp"
#include "core/io/image_file.hpp"
#include "core/pipeline/views.hpp"

namespace bpa::cli {
namespace {

// The frames that are joined, with their names.
struct JoinedFrames {
  std::vector<View> views;
  std::vector<const io::BopFrame*> entries;
  std::string name;
};

io::CameraPose camera_of(const std::vector<io::CameraPose>& cameras, std::size_t k,
                         const io::BopFrame& entry, const std::string& name) {
  if (!cameras.empty()) {
    io::CameraPose camera = cameras.at(k);
    if (camera.name.empty()) camera.name = name;
    return camera;
  }
  if (!entry.camera_from_world) {
    throw Failure(invalid_argument(concat(name,
                                          " has no pose of its camera: give --poses, or "
                                          "cam_R_w2c and cam_t_w2c in scene_camera.json")));
  }
  return {name, entry.camera_from_world->inverse()};
}

void annotate(const DetectArguments& a, const Detector& detector, const JoinedFrames& joined,
              const ViewsResult& result) {
  for (std::size_t v = 0; v < joined.views.size(); ++v) {
    Interpretation seen = result.scene.interpretations.front();
    const Pose camera_from_scene = result.scene_from_camera[v].inverse();
    for (Placement& placement : seen.placements) {
      placement = transformed(camera_from_scene, placement);
    }
    const io::BopFrame& entry = *joined.entries[v];
    const std::string file = io::bop_number(entry.scene_id) + "_" + io::bop_number(entry.im_id);
    or_throw(io::write_color_png(a.annotate + "/" + file + ".png",
                                 draw::annotate(joined.views[v].frame, seen, detector.library())));
  }
}

}  // namespace

std::vector<io::FrameResult> detect_joined(
    const DetectArguments& a, const std::vector<io::BopFrame>& entries, const Detector& detector,
    const ViewsQuestion& question,
    const std::function<void(const std::string&, const io::FrameResult&)>& print) {
  std::vector<io::CameraPose> cameras;
  if (!a.poses.empty()) cameras = or_throw(io::read_camera_poses(a.poses));
  if (!cameras.empty() && std::ssize(cameras) < a.views) {
    throw Failure(invalid_argument(
        concat(a.poses, " has ", cameras.size(), " cameras; --views asks for ", a.views)));
  }
  std::vector<io::FrameResult> results;
  JoinedFrames joined;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    Input input = read_input(a, entries[i]);
    const io::CameraPose camera = camera_of(cameras, joined.views.size(), entries[i], input.name);
    input.frame.roi = question.roi;
    input.frame.mask = question.mask;
    input.frame.frame_id = camera.name;
    joined.name += (joined.views.empty() ? "" : " + ") + input.name;
    joined.views.push_back({std::move(input.frame), camera.scene_from_camera});
    joined.entries.push_back(&entries[i]);
    const bool last = i + 1 == entries.size() || entries[i].scene_id != entries[i + 1].scene_id;
    if (std::ssize(joined.views) < a.views && !last) continue;
    const Stopwatch watch;
    const ViewsResult result =
        or_throw(detect_views(detector, joined.views, question.request), joined.name);
    print_warnings(joined.name, result.warnings);
    const io::BopFrame& first = *joined.entries.front();
    results.push_back({result.scene, first.scene_id, first.im_id, watch.seconds(), {}});
    print(joined.name, results.back());
    if (!a.annotate.empty() && !result.scene.interpretations.empty()) {
      annotate(a, detector, joined, result);
    }
    joined = {};
  }
  return results;
}

}  // namespace bpa::cli
