// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/detect_inputs.hpp"

#include <cstdio>

#include "core/io/camera_file.hpp"
#include "core/io/pcd_file.hpp"

namespace bpa::cli {
namespace {

void print_note(const std::string& path, const std::string& note) {
  if (!note.empty()) std::printf("%s: %s\n", path.c_str(), note.c_str());
}

Input read_pcd(const std::string& path, Camera camera) {
  const io::PcdCloud cloud = or_throw(io::read_pcd(path));
  if (camera.width == 0) {
    camera.width = cloud.width;
    camera.height = cloud.height;
  }
  const bool known = camera.fx != 0;
  io::OrganisedFrame organised =
      or_throw(io::frame_from_organised_cloud(cloud, known ? &camera : nullptr), path);
  for (const std::string& note : organised.notes) print_note(path, note);
  return {path, std::move(organised.frame), organised.cloud_from_camera};
}

}  // namespace

std::vector<io::BopFrame> list_inputs(const DetectArguments& a) {
  const DatasetOptions& dataset = a.dataset;
  if (!dataset.folder.empty()) {
    return or_throw(io::read_bop_frames(dataset.folder, dataset.split, dataset.scenes));
  }
  io::BopFrame entry;
  if (!a.camera.empty()) {
    const io::CameraFile file = or_throw(io::read_camera(a.camera));
    print_note(a.camera, file.note);
    entry.camera = file.camera;
    entry.depth_scale_mm = file.depth_scale_mm;
  }
  std::vector<io::BopFrame> entries;
  for (const std::string& path : a.pcd.empty() ? a.depth : a.pcd) {
    entry.im_id = static_cast<int>(entries.size());
    entry.depth_path = path;
    if (!a.color.empty()) entry.color_path = a.color[entries.size()];
    entries.push_back(entry);
  }
  return entries;
}

Input read_input(const DetectArguments& a, const io::BopFrame& entry) {
  Input input;
  if (!a.pcd.empty()) {
    input = read_pcd(entry.depth_path, entry.camera);
  } else {
    input.frame = or_throw(io::load_bop_frame(entry));
    input.frame.frame_id = std::to_string(entry.scene_id);  // one camera takes a scene's images
    input.name = a.dataset.folder.empty() ? entry.depth_path
                                          : "scene " + std::to_string(entry.scene_id) + " image " +
                                                std::to_string(entry.im_id);
  }
  clean_depth(input.frame);
  return input;
}

}  // namespace bpa::cli
