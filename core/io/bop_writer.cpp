// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/bop_writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "core/io/image_file.hpp"
#include "core/io/mesh_file.hpp"
#include "core/io/private/json_file.hpp"

namespace bpa::io {
namespace fs = std::filesystem;
namespace {

constexpr double kMillimetres = 1000;

Json symmetries_json(const SymmetryGroup& group, Json info) {
  for (const Pose& pose : group.discrete) {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    matrix.topLeftCorner<3, 3>() = pose.matrix();
    matrix.topRightCorner<3, 1>() = kMillimetres * pose.translation;
    info["symmetries_discrete"].push_back(matrix);
  }
  for (const ContinuousSymmetry& symmetry : group.continuous) {
    info["symmetries_continuous"].push_back(
        {{"axis", symmetry.axis}, {"offset", Eigen::Vector3d(kMillimetres * symmetry.point)}});
  }
  return info;
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
  return symmetries_json(model.symmetry, std::move(info));
}

struct MaskExtent {
  int count = 0;
  Json box = {-1, -1, -1, -1};  // x, y, width, height, as the toolkit does
};

MaskExtent extent(const std::vector<std::uint8_t>& mask, int width) {
  MaskExtent result;
  int left = width, right = -1, top = -1, bottom = -1;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] == 0) continue;
    const int x = static_cast<int>(i) % width;
    const int y = static_cast<int>(i) / width;
    left = std::min(left, x);
    right = std::max(right, x);
    if (top < 0) top = y;
    bottom = y;
    ++result.count;
  }
  if (result.count > 0) result.box = {left, top, right - left + 1, bottom - top + 1};
  return result;
}

Json info_json(const BopInstanceRecord& instance, const Frame& frame) {
  const MaskExtent seen = extent(instance.mask_visible, frame.camera.width);
  if (instance.mask.empty()) {
    return {{"bbox_visib", seen.box},
            {"px_count_visib", seen.count},
            {"visib_fract", instance.visible_fraction}};
  }
  const MaskExtent all = extent(instance.mask, frame.camera.width);
  int valid = 0;
  for (std::size_t i = 0; i < instance.mask.size(); ++i) {
    valid += instance.mask[i] != 0 && frame.depth[i] > 0;
  }
  return {{"bbox_obj", all.box},
          {"bbox_visib", seen.box},
          {"px_count_all", all.count},
          {"px_count_valid", valid},
          {"px_count_visib", seen.count},
          {"visib_fract", all.count > 0 ? static_cast<double>(seen.count) / all.count : 0.0}};
}

Status write_mask(const std::string& path, const Frame& frame, const char* field,
                  const std::vector<std::uint8_t>& mask) {
  if (mask.empty()) return {};
  if (mask.size() != frame.depth.size()) {
    return invalid_argument(std::string(field) + " has " + std::to_string(mask.size()) +
                            " values; it must have one for each pixel of the frame");
  }
  std::vector<std::uint8_t> bytes(mask.size());
  for (std::size_t i = 0; i < mask.size(); ++i) bytes[i] = mask[i] != 0 ? 255 : 0;
  return write_mask_png(path, frame.camera.width, frame.camera.height, bytes);
}

Status write_images(const fs::path& folder, int im_id, const Frame& frame, double depth_scale_mm) {
  GrayImage depth{frame.camera.width, frame.camera.height, {}};
  depth.pixels.resize(frame.depth.size());
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    const double units = std::round(frame.depth[i] * kMillimetres / depth_scale_mm);
    depth.pixels[i] =
        units > 0 && units <= 65535 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
  }
  const std::string name = bop_number(im_id) + ".png";
  if (Status s = write_gray_png((folder / "depth" / name).string(), depth); !s.ok()) return s;
  if (frame.color.empty()) return {};
  return write_color_png((folder / "rgb" / name).string(),
                         {frame.camera.width, frame.camera.height, frame.color});
}

}  // namespace

Status write_bop_models(const std::string& dataset, const std::vector<BopMesh>& meshes) {
  const fs::path folder = fs::path(dataset) / "models";
  Json info = Json::object();
  for (const BopMesh& model : meshes) {
    const std::string path = (folder / (bop_object_name(model.obj_id) + ".ply")).string();
    if (Status s = write_ply(path, model.mesh, kMillimetres); !s.ok()) return s;
    info[std::to_string(model.obj_id)] = model_json(model);
  }
  return write_file((folder / "models_info.json").string(), info.dump(1) + "\n");
}

struct BopSceneWriter::Records {
  Json camera = Json::object();
  Json gt = Json::object();
  Json info = Json::object();
};

BopSceneWriter::BopSceneWriter(const std::string& dataset, const std::string& split, int scene_id,
                               double depth_scale_mm)
    : folder_((fs::path(dataset) / split / bop_number(scene_id)).string()),
      depth_scale_mm_(depth_scale_mm),
      records_(std::make_unique<Records>()) {}

BopSceneWriter::~BopSceneWriter() = default;

Status BopSceneWriter::add(int im_id, const Frame& frame,
                           const std::vector<BopInstanceRecord>& instances) {
  const fs::path folder(folder_);
  if (Status s = write_images(folder, im_id, frame, depth_scale_mm_); !s.ok()) return s;
  Json gt = Json::array();
  Json info = Json::array();
  for (std::size_t i = 0; i < instances.size(); ++i) {
    const BopInstanceRecord& instance = instances[i];
    const std::string name = bop_number(im_id) + "_" + bop_number(static_cast<int>(i)) + ".png";
    Status s = write_mask((folder / "mask_visib" / name).string(), frame, "mask_visible",
                          instance.mask_visible);
    if (s.ok()) s = write_mask((folder / "mask" / name).string(), frame, "mask", instance.mask);
    if (!s.ok()) return s;
    gt.push_back(
        {{"obj_id", instance.obj_id},
         {"cam_R_m2c", instance.camera_from_object.matrix()},
         {"cam_t_m2c", Eigen::Vector3d(kMillimetres * instance.camera_from_object.translation)}});
    info.push_back(info_json(instance, frame));
  }
  const std::string key = std::to_string(im_id);
  const Camera& c = frame.camera;
  records_->camera[key] = {{"cam_K", {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}},
                           {"depth_scale", depth_scale_mm_}};
  records_->gt[key] = gt;
  records_->info[key] = info;
  return {};
}

Status BopSceneWriter::finish() {
  const fs::path folder(folder_);
  const auto write = [&folder](const char* name, const Json& json) {
    return write_file((folder / name).string(), json.dump(1) + "\n");
  };
  if (Status s = write("scene_camera.json", records_->camera); !s.ok()) return s;
  if (Status s = write("scene_gt.json", records_->gt); !s.ok()) return s;
  return write("scene_gt_info.json", records_->info);
}

}  // namespace bpa::io
