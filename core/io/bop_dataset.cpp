// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/bop_dataset.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>

#include "core/io/image_file.hpp"
#include "core/io/private/json_file.hpp"

namespace bpa::io {
namespace fs = std::filesystem;
namespace {

constexpr double kMetres = 0.001;

SymmetryGroup read_symmetry(const Json& info) {
  SymmetryGroup group;
  for (Eigen::Matrix4d matrix : info.value("symmetries_discrete", std::vector<Eigen::Matrix4d>())) {
    matrix.topRightCorner<3, 1>() *= kMetres;
    group.discrete.push_back(Pose::from_matrix(matrix));
  }
  for (const Json& json : info.value("symmetries_continuous", Json::array())) {
    const Eigen::Vector3d offset = json.value("offset", Eigen::Vector3d(0, 0, 0));
    group.continuous.push_back(
        {json.at("axis").get<Eigen::Vector3d>().normalized(), kMetres * offset});
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
  if (!gt.contains(key)) return {};
  for (const Json& json : gt.at(key)) {
    BopInstance& instance = frame.truth.emplace_back();
    instance.obj_id = json.at("obj_id").get<int>();
    instance.camera_from_object =
        Pose::from_matrix(json.at("cam_R_m2c").get<Eigen::Matrix3d>(),
                          kMetres * json.at("cam_t_m2c").get<Eigen::Vector3d>());
    const std::size_t i = frame.truth.size() - 1;
    if (info.contains(key) && i < info.at(key).size()) {
      instance.visible_fraction = info.at(key).at(i).value("visib_fract", 1.0);
    }
  }
  return {};
}

Result<BopFrame> read_frame_entry(const fs::path& folder, int scene_id, const std::string& key,
                                  const Json& camera) {
  BopFrame frame;
  frame.scene_id = scene_id;
  frame.im_id = std::stoi(key);
  frame.camera = camera_of(camera.at("cam_K").get<std::array<double, 9>>());
  frame.depth_scale_mm = camera.value("depth_scale", 1.0);
  frame.depth_path = (folder / "depth" / (bop_number(frame.im_id) + ".png")).string();
  frame.color_path = find_image(folder / "rgb", frame.im_id);
  const Result<ImageSize> size = read_png_size(frame.depth_path);
  if (!size.ok()) return size.status();
  frame.camera.width = size->width;
  frame.camera.height = size->height;
  return frame;
}

/// An empty object where there is no file.
Result<Json> read_optional_json(const std::string& path) {
  return fs::exists(path) ? read_json(path) : Json::object();
}

Status read_scene(const fs::path& folder, int scene_id, std::vector<BopFrame>& frames) {
  const std::string gt_path = (folder / "scene_gt.json").string();
  return read_json((folder / "scene_camera.json").string(), [&](const Json& cameras) -> Status {
    const Result<Json> gt = read_optional_json(gt_path);
    if (!gt.ok()) return gt.status();
    const Result<Json> info = read_optional_json((folder / "scene_gt_info.json").string());
    if (!info.ok()) return info.status();
    for (const auto& [key, camera] : cameras.items()) {
      Result<BopFrame> frame = read_frame_entry(folder, scene_id, key, camera);
      if (!frame.ok()) return frame.status();
      frame->has_truth = fs::exists(gt_path);
      Status status = with_json(gt_path, [&]() { return read_truth(*gt, *info, key, *frame); });
      if (!status.ok()) return status;
      frames.push_back(std::move(*frame));
    }
    return {};
  });
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
  return read_json(path, [&](const Json& json) -> Result<std::vector<BopModel>> {
    std::vector<BopModel> models;
    for (const auto& [key, info] : json.items()) {
      BopModel& model = models.emplace_back();
      model.obj_id = std::stoi(key);
      model.name = info.value("name", bop_object_name(model.obj_id));
      model.path =
          (fs::path(dataset) / "models" / (bop_object_name(model.obj_id) + ".ply")).string();
      model.diameter = kMetres * info.at("diameter").get<double>();
      model.symmetry = read_symmetry(info);
    }
    std::ranges::sort(models, {}, &BopModel::obj_id);
    return models;
  });
}

Result<std::vector<BopFrame>> read_bop_frames(const std::string& dataset, const std::string& split,
                                              const std::vector<int>& scenes) {
  const fs::path folder = fs::path(dataset) / split;
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return not_found(folder.string(), " is not there: the data set has no split \"", split, "\"");
  }
  std::set<int> found;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.size() == 6 && name.find_first_not_of("0123456789") == std::string::npos) {
      found.insert(std::stoi(name));
    }
  }
  for (const int scene : scenes) {
    if (!found.contains(scene)) return not_found(folder.string(), " has no scene ", scene);
  }
  std::vector<BopFrame> frames;
  for (const int scene : scenes.empty() ? found : std::set(scenes.begin(), scenes.end())) {
    if (Status s = read_scene(folder / bop_number(scene), scene, frames); !s.ok()) return s;
  }
  if (frames.empty()) return not_found(folder.string(), " has no frames");
  std::ranges::sort(frames, {}, [](const BopFrame& f) { return std::pair(f.scene_id, f.im_id); });
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
