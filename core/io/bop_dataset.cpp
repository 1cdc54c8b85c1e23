// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/bop_dataset.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/io/frame_file.hpp"
#include "core/io/image_file.hpp"
#include "core/io/private/json_file.hpp"

namespace bpa::io {
namespace fs = std::filesystem;
namespace {

constexpr double kMetres = 0.001;

SymmetryGroup read_symmetry(const Json& info) {
  SymmetryGroup group;
  if (info.contains("symmetries_discrete")) {
    for (const Json& json : info.at("symmetries_discrete")) {
      auto matrix = json.get<Eigen::Matrix4d>();
      matrix.topRightCorner<3, 1>() *= kMetres;
      group.discrete.push_back(Pose::from_matrix(matrix));
    }
  }
  if (info.contains("symmetries_continuous")) {
    for (const Json& json : info.at("symmetries_continuous")) {
      const Eigen::Vector3d offset = json.value("offset", Eigen::Vector3d(0, 0, 0));
      group.continuous.push_back(
          {json.at("axis").get<Eigen::Vector3d>().normalized(), kMetres * offset});
    }
  }
  return group;
}

/// The image with that number, whatever its extension; empty if there is none.
std::string find_image(const fs::path& folder, int im_id) {
  for (const char* extension : {".png", ".jpg", ".jpeg"}) {
    const fs::path path = folder / (bop_number(im_id) + extension);
    if (fs::exists(path)) return path.string();
  }
  return {};
}

Status read_truth(const Json& gt, const Json& info, const std::string& key, BopFrame& frame) {
  frame.has_truth = true;
  if (!gt.contains(key)) return {};
  const Json& instances = gt.at(key);
  for (std::size_t i = 0; i < instances.size(); ++i) {
    const Json& json = instances.at(i);
    BopInstance instance;
    instance.obj_id = json.at("obj_id").get<int>();
    instance.camera_from_object =
        Pose::from_matrix(json.at("cam_R_m2c").get<Eigen::Matrix3d>(),
                          kMetres * json.at("cam_t_m2c").get<Eigen::Vector3d>());
    if (info.contains(key) && i < info.at(key).size()) {
      instance.visible_fraction = info.at(key).at(i).value("visib_fract", 1.0);
    }
    frame.truth.push_back(instance);
  }
  return {};
}

Result<BopFrame> read_frame_entry(const fs::path& folder, int scene_id, const std::string& key,
                                  const Json& camera) {
  BopFrame frame;
  frame.scene_id = scene_id;
  frame.im_id = std::stoi(key);
  const auto k = camera.at("cam_K").get<std::array<double, 9>>();
  frame.camera = {0, 0, k[0], k[4], k[2], k[5]};
  frame.depth_scale_mm = camera.value("depth_scale", 1.0);
  frame.depth_path = (folder / "depth" / (bop_number(frame.im_id) + ".png")).string();
  frame.color_path = find_image(folder / "rgb", frame.im_id);
  const Result<ImageSize> size = read_png_size(frame.depth_path);
  if (!size.ok()) return size.status();
  frame.camera.width = size->width;
  frame.camera.height = size->height;
  return frame;
}

Status read_scene(const fs::path& folder, int scene_id, std::vector<BopFrame>& frames) {
  const std::string camera_path = (folder / "scene_camera.json").string();
  const std::string gt_path = (folder / "scene_gt.json").string();
  const std::string info_path = (folder / "scene_gt_info.json").string();
  const Result<Json> cameras = read_json(camera_path);
  if (!cameras.ok()) return cameras.status();
  Result<Json> gt = fs::exists(gt_path) ? read_json(gt_path) : Json::object();
  if (!gt.ok()) return gt.status();
  Result<Json> info = fs::exists(info_path) ? read_json(info_path) : Json::object();
  if (!info.ok()) return info.status();
  for (const auto& [key, camera] : cameras->items()) {
    Result<BopFrame> frame =
        with_json(camera_path, [&]() { return read_frame_entry(folder, scene_id, key, camera); });
    if (!frame.ok()) return frame.status();
    if (fs::exists(gt_path)) {
      Status status =
          with_json(gt_path, [&]() -> Status { return read_truth(*gt, *info, key, *frame); });
      if (!status.ok()) return status;
    }
    frames.push_back(std::move(*frame));
  }
  return {};
}

}  // namespace

std::string bop_number(int number) {
  char text[16];
  std::snprintf(text, sizeof text, "%06d", number);
  return text;
}

std::string bop_object_name(int obj_id) { return "obj_" + bop_number(obj_id); }

Result<std::vector<BopModel>> read_bop_models(const std::string& dataset) {
  const std::string path = (fs::path(dataset) / "models" / "models_info.json").string();
  const Result<Json> json = read_json(path);
  if (!json.ok()) return json.status();
  return with_json(path, [&]() -> Result<std::vector<BopModel>> {
    std::vector<BopModel> models;
    for (const auto& [key, info] : json->items()) {
      BopModel model;
      model.obj_id = std::stoi(key);
      model.name = info.value("name", bop_object_name(model.obj_id));
      model.path =
          (fs::path(dataset) / "models" / (bop_object_name(model.obj_id) + ".ply")).string();
      model.diameter = kMetres * info.at("diameter").get<double>();
      model.symmetry = read_symmetry(info);
      models.push_back(std::move(model));
    }
    std::sort(models.begin(), models.end(),
              [](const BopModel& a, const BopModel& b) { return a.obj_id < b.obj_id; });
    return models;
  });
}

Result<std::vector<BopFrame>> read_bop_frames(const std::string& dataset, const std::string& split,
                                              const std::vector<int>& scenes) {
  const fs::path folder = fs::path(dataset) / split;
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return Status(StatusCode::not_found,
                  folder.string() + " is not there: the data set has no split \"" + split + "\"");
  }
  std::vector<int> found;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.size() == 6 && name.find_first_not_of("0123456789") == std::string::npos) {
      found.push_back(std::stoi(name));
    }
  }
  std::sort(found.begin(), found.end());
  for (const int scene : scenes) {
    if (std::find(found.begin(), found.end(), scene) == found.end()) {
      return Status(StatusCode::not_found,
                    folder.string() + " has no scene " + std::to_string(scene));
    }
  }
  std::vector<BopFrame> frames;
  for (const int scene : found) {
    if (!scenes.empty() && std::find(scenes.begin(), scenes.end(), scene) == scenes.end()) continue;
    if (Status s = read_scene(folder / bop_number(scene), scene, frames); !s.ok()) return s;
  }
  if (frames.empty()) return Status(StatusCode::not_found, folder.string() + " has no frames");
  std::sort(frames.begin(), frames.end(), [](const BopFrame& a, const BopFrame& b) {
    return std::pair(a.scene_id, a.im_id) < std::pair(b.scene_id, b.im_id);
  });
  return frames;
}

Result<Frame> load_bop_frame(const BopFrame& frame) {
  Result<Frame> loaded =
      read_frame(frame.depth_path, frame.color_path, frame.camera, frame.depth_scale_mm);
  if (loaded.ok()) {
    loaded->frame_id = std::to_string(frame.scene_id) + "/" + std::to_string(frame.im_id);
  }
  return loaded;
}

}  // namespace bpa::io
