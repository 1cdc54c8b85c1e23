// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/bop_dataset.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <set>

#include "core/cloud/undistortion.hpp"
#include "core/io/image_file.hpp"
#include "core/io/mesh_file.hpp"
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
  for (const char* extension : {".png", ".jpg", ".jpeg", ".npy", ".tif", ".tiff"}) {
    const std::string path = (folder / (bop_number(im_id) + extension)).string();
    if (is_file(path)) return path;
  }
  return {};
}

Pose pose_of(const Json& json, const char* rotation, const char* translation) {
  return Pose::from_matrix(json.at(rotation).get<Eigen::Matrix3d>(),
                           kMetres * json.at(translation).get<Eigen::Vector3d>());
}

void set_pose(Json& json, const char* rotation, const char* translation, const Pose& pose) {
  json[rotation] = pose.matrix();
  json[translation] = Eigen::Vector3d(kMillimetres * pose.translation);
}

Status read_truth(const Json& gt, const Json& info, const std::string& key, BopFrame& frame) {
  if (!gt.contains(key)) return {};
  for (const Json& json : gt.at(key)) {
    BopInstance& instance = frame.truth.emplace_back();
    instance.obj_id = whole_number<int>(json.at("obj_id"));
    instance.camera_from_object = pose_of(json, "cam_R_m2c", "cam_t_m2c");
    instance.instance = whole_number(json, "instance_id", 0);
    const std::size_t i = frame.truth.size() - 1;
    if (info.contains(key) && i < info.at(key).size()) {
      instance.visible_fraction = info.at(key).at(i).value("visib_fract", 1.0);
    }
  }
  return {};
}

BopFrame read_frame_entry(const fs::path& folder, const std::string& suffix, int scene_id,
                          const std::string& key, const Json& camera) {
  const auto known =
      camera_of(camera, (folder / ("scene_camera" + suffix + ".json")).string() + ": " + key);
  BopFrame frame;
  frame.unread = known.status();
  frame.scene_id = scene_id;
  frame.im_id = std::stoi(key);
  if (known.ok()) {
    frame.camera = known->camera;
    frame.depth_scale_mm = known->depth_scale_mm;
  }
  frame.stamp_ns = whole_number<std::int64_t>(camera, "stamp_ns", 0);
  if (camera.contains("cam_R_w2c")) {
    frame.camera_from_world = pose_of(camera, "cam_R_w2c", "cam_t_w2c");
  }
  const fs::path depth = folder / ("depth" + suffix);
  frame.depth_path = find_image(depth, frame.im_id);
  if (frame.depth_path.empty()) {
    frame.depth_path = (depth / (bop_number(frame.im_id) + ".png")).string();
  }
  for (const char* images : {"rgb", "gray"}) {
    if (frame.color_path.empty()) {
      frame.color_path = find_image(folder / (images + suffix), frame.im_id);
    }
  }
  // The images say it; without one, the frame fails when it is loaded.
  const Result<ImageSize> size = read_png_size(frame.depth_path);
  frame.camera.width = size.ok() ? size->width : 0;
  frame.camera.height = size.ok() ? size->height : 0;
  return frame;
}

/// An empty object where there is no file.
Result<Json> read_optional_json(const std::string& path) {
  return is_file(path) ? read_json(path) : Json::object();
}

Status read_scene(const fs::path& folder, int scene_id, std::vector<BopFrame>& frames) {
  if (is_file((folder / "info.yml").string())) {
    return Status(StatusCode::unsupported,
                  folder.string() +
                      " is in the layout of SIXD and LINEMOD (info.yml, gt.yml); take "
                      "the data set of the same name in BOP's layout, from "
                      "bop.felk.cvut.cz/datasets");
  }
  // Of several cameras, as data sets of BOP for industry have them: the first.
  const std::string suffix = is_file((folder / "scene_camera_cam1.json").string()) ? "_cam1" : "";
  const auto path_of = [&](const std::string& name) {
    return (folder / (name + suffix + ".json")).string();
  };
  const std::string gt_path = path_of("scene_gt");
  return read_json(path_of("scene_camera"), [&](const Json& cameras) -> Status {
    const Result<Json> gt = read_optional_json(gt_path);
    if (!gt.ok()) return gt.status();
    const Result<Json> info = read_optional_json(path_of("scene_gt_info"));
    if (!info.ok()) return info.status();
    for (const auto& [key, camera] : cameras.items()) {
      BopFrame& frame =
          frames.emplace_back(read_frame_entry(folder, suffix, scene_id, key, camera));
      frame.has_truth = is_file(gt_path);
      Status status =
          with_json(gt_path, [&, &of = key]() { return read_truth(*gt, *info, of, frame); });
      if (!status.ok()) return status;
    }
    return {};
  });
}

Json model_json(const BopMesh& model) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : model.mesh.vertices) box.extend(vertex);
  const Eigen::Vector3d low = kMillimetres * box.min().cast<double>();
  const Eigen::Vector3d size = kMillimetres * box.sizes().cast<double>();
  Json info = {{"name", model.name}, {"diameter", kMillimetres * model.diameter},
               {"min_x", low.x()},   {"min_y", low.y()},
               {"min_z", low.z()},   {"size_x", size.x()},
               {"size_y", size.y()}, {"size_z", size.z()}};
  for (const Pose& pose : model.symmetry.discrete) {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    matrix.topLeftCorner<3, 3>() = pose.matrix();
    matrix.topRightCorner<3, 1>() = kMillimetres * pose.translation;
    info["symmetries_discrete"].push_back(matrix);
  }
  for (const ContinuousSymmetry& symmetry : model.symmetry.continuous) {
    info["symmetries_continuous"].push_back(
        {{"axis", symmetry.axis}, {"offset", Eigen::Vector3d(kMillimetres * symmetry.point)}});
  }
  return info;
}

/// x, y, width and height of the pixels of a mask, as the toolkit does.
Json box_json(const std::vector<std::uint8_t>& mask, int width) {
  Eigen::AlignedBox2i box;
  for (int i = 0; i < static_cast<int>(mask.size()); ++i) {
    if (mask[i]) box.extend(Eigen::Vector2i(i % width, i / width));
  }
  if (box.isEmpty()) return {-1, -1, -1, -1};
  const Eigen::Vector2i size = box.sizes() + Eigen::Vector2i::Ones();
  return {box.min().x(), box.min().y(), size.x(), size.y()};
}

Json info_json(const BopInstanceRecord& instance, const Frame& frame) {
  const auto count = [](const auto& mask) {
    return mask.size() - static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 0));
  };
  const std::size_t seen = count(instance.mask_visible);
  Json info = {{"bbox_visib", box_json(instance.mask_visible, frame.camera.width)},
               {"px_count_visib", seen},
               {"visib_fract", instance.visible_fraction}};
  if (instance.mask.empty()) return info;
  const std::size_t all = count(instance.mask);
  int valid = 0;
  for (std::size_t i = 0; i < instance.mask.size(); ++i) {
    valid += instance.mask[i] != 0 && frame.depth[i] > 0;
  }
  info["bbox_obj"] = box_json(instance.mask, frame.camera.width);
  info["px_count_all"] = all;
  info["px_count_valid"] = valid;
  info["visib_fract"] = all > 0 ? static_cast<double>(seen) / static_cast<double>(all) : 0.0;
  return info;
}

Status check_mask(const char* field, const std::vector<std::uint8_t>& mask, const Frame& frame) {
  if (mask.empty() || mask.size() == frame.depth.size()) return {};
  return invalid_argument(field, " has ", mask.size(),
                          " values; it must have one for each pixel of the frame");
}

Status write_mask(const std::string& path, const Frame& frame,
                  const std::vector<std::uint8_t>& mask) {
  std::vector<std::uint8_t> bytes = mask;
  for (std::uint8_t& value : bytes) value = value != 0 ? 255 : 0;
  return write_mask_png(path, frame.camera.width, frame.camera.height, bytes);
}

Status write_images(const fs::path& folder, int im_id, const Frame& frame, double depth_scale_mm) {
  GrayImage depth{frame.camera.width, frame.camera.height, {}};
  for (const float z : frame.depth) {
    const double units = std::round(z * kMillimetres / depth_scale_mm);
    depth.pixels.push_back(static_cast<std::uint16_t>(units > 0 && units <= 65535 ? units : 0.0));
  }
  const std::string name = bop_number(im_id) + ".png";
  if (Status s = write_gray_png((folder / "depth" / name).string(), depth); !s.ok()) return s;
  if (frame.color.empty()) return {};
  return write_color_png((folder / "rgb" / name).string(),
                         {frame.camera.width, frame.camera.height, frame.color});
}

}  // namespace

std::string bop_number(int number) { return format("%06d", number); }

std::string bop_object_name(int obj_id) { return "obj_" + bop_number(obj_id); }

Result<std::vector<BopModel>> read_bop_models(const std::string& dataset) {
  const fs::path folder(dataset);
  for (const char* other : {"models_cad", "models_reconst", "models_eval"}) {
    if (is_folder((folder / "models").string()) || !is_folder((folder / other).string())) continue;
    return read_bop_models_folder((folder / other).string());
  }
  return read_bop_models_folder((folder / "models").string());
}

Result<std::vector<BopModel>> read_bop_models_folder(const std::string& folder) {
  const std::string path = (fs::path(folder) / "models_info.json").string();
  return read_json(path, [&](const Json& json) -> Result<std::vector<BopModel>> {
    std::vector<BopModel> models;
    for (const auto& [key, info] : json.items()) {
      BopModel& model = models.emplace_back();
      model.obj_id = std::stoi(key);
      model.name = info.value("name", bop_object_name(model.obj_id));
      model.path = (fs::path(folder) / (bop_object_name(model.obj_id) + ".ply")).string();
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
    std::set<std::string> splits;
    for (const auto& entry : fs::directory_iterator(dataset, error)) {
      if (entry.is_directory(error)) splits.insert(entry.path().filename().string());
    }
    return not_found(folder.string(), " is not there: the data set has no split \"", split,
                     "\"; its folders: ", listed(splits), " (--split NAME)");
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

Result<Frame> load_bop_frame(const BopFrame& frame, std::string* note) {
  if (!frame.unread.ok()) return frame.unread;
  Result<Frame> loaded =
      read_frame(frame.depth_path, frame.color_path, frame.camera, frame.depth_scale_mm, note);
  if (loaded.ok()) {
    undistort(frame.lens, *loaded);
    loaded->stamp_ns = frame.stamp_ns;
    loaded->frame_id = std::to_string(frame.scene_id) + "/" + std::to_string(frame.im_id);
  }
  return loaded;
}

Status write_bop_models(const std::string& dataset, const std::vector<BopMesh>& meshes) {
  const fs::path folder = fs::path(dataset) / "models";
  Json info = Json::object();
  for (const BopMesh& model : meshes) {
    const std::string path = (folder / (bop_object_name(model.obj_id) + ".ply")).string();
    if (Status s = write_ply(path, model.mesh, kMillimetres); !s.ok()) return s;
    info[std::to_string(model.obj_id)] = model_json(model);
  }
  return write_file((folder / "models_info.json").string(), written(info, 1) + "\n");
}

struct BopSceneWriter::Records {
  std::mutex mutex;
  Json camera = Json::object();
  Json gt = Json::object();
  Json info = Json::object();
};

BopSceneWriter::BopSceneWriter(const std::string& dataset, const std::string& split, int scene_id,
                               double depth_scale_mm, BopMasks masks)
    : folder_((fs::path(dataset) / split / bop_number(scene_id)).string()),
      depth_scale_mm_(depth_scale_mm),
      masks_(masks),
      records_(std::make_unique<Records>()) {}

BopSceneWriter::~BopSceneWriter() = default;

Status BopSceneWriter::add(int im_id, const Frame& frame,
                           const std::vector<BopInstanceRecord>& instances,
                           const std::optional<Pose>& camera_from_world) {
  const fs::path folder(folder_);
  if (Status s = write_images(folder, im_id, frame, depth_scale_mm_); !s.ok()) return s;
  Json gt = Json::array();
  Json info = Json::array();
  for (std::size_t i = 0; i < instances.size(); ++i) {
    const BopInstanceRecord& instance = instances[i];
    const std::string name = bop_number(im_id) + "_" + bop_number(static_cast<int>(i)) + ".png";
    for (const auto& [kind, mask] :
         {std::pair("mask_visib", &instance.mask_visible), std::pair("mask", &instance.mask)}) {
      if (Status s = check_mask(kind, *mask, frame); !s.ok()) return s;
      if (masks_ == BopMasks::counted || mask->empty()) continue;
      if (Status s = write_mask((folder / kind / name).string(), frame, *mask); !s.ok()) return s;
    }
    Json& entry = gt.emplace_back(Json{{"obj_id", instance.obj_id}});
    set_pose(entry, "cam_R_m2c", "cam_t_m2c", instance.camera_from_object);
    if (instance.instance != 0) entry["instance_id"] = instance.instance;
    info.push_back(info_json(instance, frame));
  }
  const Camera& c = frame.camera;
  Json camera = {{"cam_K", {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}},
                 {"depth_scale", depth_scale_mm_}};
  if (frame.stamp_ns != 0) camera["stamp_ns"] = frame.stamp_ns;
  if (camera_from_world) set_pose(camera, "cam_R_w2c", "cam_t_w2c", *camera_from_world);
  const std::string key = std::to_string(im_id);
  const std::lock_guard lock(records_->mutex);
  records_->camera[key] = std::move(camera);
  records_->gt[key] = std::move(gt);
  records_->info[key] = std::move(info);
  return {};
}

Status BopSceneWriter::finish() {
  const std::pair<const char*, const Json&> files[] = {{"scene_camera.json", records_->camera},
                                                       {"scene_gt.json", records_->gt},
                                                       {"scene_gt_info.json", records_->info}};
  for (const auto& [name, json] : files) {
    const std::string path = (fs::path(folder_) / name).string();
    if (Status s = write_file(path, json.dump(1) + "\n"); !s.ok()) return s;
  }
  return {};
}

}  // namespace bpa::io
