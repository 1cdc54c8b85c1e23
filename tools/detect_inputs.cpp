// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/detect_inputs.hpp"

#include <cstdio>

#include "core/io/camera_file.hpp"
#include "core/io/frame_file.hpp"
#include "core/io/image_file.hpp"
#include "core/io/pcd_file.hpp"
#include "core/io/pose_prior_file.hpp"

namespace bpa::cli {
namespace {

Result<Input> read_bop(const io::BopFrame& entry) {
  Result<Frame> frame = io::load_bop_frame(entry);
  if (!frame.ok()) return frame.status();
  Input input;
  input.name = "scene " + std::to_string(entry.scene_id) + " image " + std::to_string(entry.im_id);
  input.frame = std::move(*frame);
  input.frame.frame_id = std::to_string(entry.scene_id);  // one camera takes a scene's images
  input.scene_id = entry.scene_id;
  input.im_id = entry.im_id;
  input.has_truth = entry.has_truth;
  input.truth = entry.truth;
  return input;
}

}  // namespace

std::string file_name(const Input& input) {
  char name[32];
  std::snprintf(name, sizeof name, "%06d_%06d", input.scene_id, input.im_id);
  return name;
}

Result<Inputs> Inputs::open(const DetectArguments& arguments) {
  Inputs inputs(arguments);
  const DatasetOptions& dataset = arguments.dataset;
  if (dataset.folder.empty()) return inputs;
  Result<std::vector<io::BopFrame>> frames =
      io::read_bop_frames(dataset.folder, dataset.split, dataset.scenes);
  if (!frames.ok()) return frames.status();
  inputs.bop_ = std::move(*frames);
  return inputs;
}

std::size_t Inputs::size() const {
  if (!a_->dataset.folder.empty()) return bop_.size();
  return a_->pcd.empty() ? a_->depth.size() : a_->pcd.size();
}

bool Inputs::ends_scene(std::size_t index) const {
  if (index + 1 == size()) return true;
  return !a_->dataset.folder.empty() && bop_[index].scene_id != bop_[index + 1].scene_id;
}

Result<Input> Inputs::read(std::size_t index) const {
  Result<Input> input = !a_->dataset.folder.empty() ? read_bop(bop_[index])
                        : a_->pcd.empty()           ? read_png(index)
                                                    : read_pcd(index);
  if (input.ok()) clean_depth(input->frame);
  return input;
}

Result<Input> Inputs::read_pcd(std::size_t index) const {
  const std::string& path = a_->pcd[index];
  const Result<io::PcdCloud> cloud = io::read_pcd(path);
  if (!cloud.ok()) return cloud.status();
  Result<io::OrganisedFrame> organised = Status(StatusCode::internal, "not read");
  if (a_->camera.empty()) {
    organised = io::frame_from_organised_cloud(*cloud);
  } else {
    Result<io::CameraFile> camera = io::read_camera(a_->camera);
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
  input.name = path;
  input.im_id = static_cast<int>(index);
  input.frame = std::move(organised->frame);
  input.reported_from_camera = organised->cloud_from_camera;
  return input;
}

Result<Input> Inputs::read_png(std::size_t index) const {
  const Result<io::CameraFile> camera = io::read_camera(a_->camera);
  if (!camera.ok()) return camera.status();
  if (!camera->note.empty() && index == 0) {
    std::printf("%s: %s\n", a_->camera.c_str(), camera->note.c_str());
  }
  Result<Frame> frame = io::read_frame(a_->depth[index], a_->color.empty() ? "" : a_->color[index],
                                       camera->camera, camera->depth_scale_mm);
  if (!frame.ok()) return frame.status();
  Input input;
  input.name = a_->depth[index];
  input.im_id = static_cast<int>(index);
  input.frame = std::move(*frame);
  return input;
}

Result<Given> read_given(const DetectArguments& a) {
  Given given;
  if (!a.roi.empty()) given.roi = {a.roi[0], a.roi[1], a.roi[2], a.roi[3]};
  if (!a.mask.empty()) {
    const Result<io::GrayImage> mask = io::read_gray_png(a.mask);
    if (!mask.ok()) return mask.status();
    for (const std::uint16_t value : mask->pixels) given.mask.push_back(value > 0);
  }
  Result<std::vector<PosePrior>> priors = io::read_pose_priors(a.priors);
  if (!priors.ok()) return priors.status();
  given.priors = std::move(*priors);
  return given;
}

}  // namespace bpa::cli
