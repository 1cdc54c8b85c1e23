// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/camera_file.hpp"

#include <algorithm>
#include <cmath>

#include <yaml-cpp/yaml.h>

#include "core/io/private/json_file.hpp"
#include "core/io/yaml_text.hpp"

namespace bpa::io {
namespace {

Status check(const std::string& path, const CameraFile& file) {
  const std::pair<const char*, double> positive[] = {
      {"fx", file.camera.fx}, {"fy", file.camera.fy}, {"depth_scale", file.depth_scale_mm}};
  for (const auto& [field, value] : positive) {
    if (std::isfinite(value) && value > 0) continue;
    return invalid_argument(path, ": ", field, " is ", value, "; it must be positive");
  }
  if (file.camera.width == 0 && file.camera.height == 0) return {};
  Status status = validate(file.camera);
  if (!status.ok()) status.message = path + ": " + status.message;
  return status;
}

CameraFile from_json(const Json& json) {
  CameraFile file;
  Camera& camera = file.camera;
  if (json.contains("cam_K")) {
    camera = camera_of(json.at("cam_K").get<std::array<double, 9>>());
  } else {
    camera = {0, 0, json.at("fx"), json.at("fy"), json.at("cx"), json.at("cy")};
  }
  camera.width = whole_number(json, "width", 0);
  camera.height = whole_number(json, "height", 0);
  file.depth_scale_mm = json.value("depth_scale", 1.0);
  return file;
}

CameraFile from_yaml(const YAML::Node& yaml) {
  CameraFile file;
  file.camera = camera_of(yaml["camera_matrix"]["data"].as<std::array<double, 9>>());
  file.camera.width = yaml["image_width"].as<int>();
  file.camera.height = yaml["image_height"].as<int>();
  if (const YAML::Node distortion = yaml["distortion_coefficients"]) {
    file.distortion = distortion["data"].as<std::vector<double>>();
    if (std::ranges::any_of(file.distortion, [](double d) { return d != 0; })) {
      file.note = "its distortion is ignored: images must be rectified";
    }
  }
  if (const YAML::Node scale = yaml["depth_scale"]) file.depth_scale_mm = scale.as<double>();
  return file;
}

Result<CameraFile> read_yaml(const std::string& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  try {
    return from_yaml(parse_yaml(*bytes));
  } catch (const std::exception& error) {
    return corrupt(path,
                   " is not a ROS camera_info file (image_width, image_height, "
                   "camera_matrix.data of 9): ",
                   error.what());
  }
}

}  // namespace

Result<CameraFile> read_camera(const std::string& path) {
  const std::string extension = lower_extension(path);
  Result<CameraFile> file =
      Status(StatusCode::unsupported, path + " is not a camera file; use .json or .yaml");
  if (extension == "json") {
    file = read_json(path, [](const Json& json) -> Result<CameraFile> { return from_json(json); });
  } else if (extension == "yaml" || extension == "yml") {
    file = read_yaml(path);
  }
  if (!file.ok()) return file;
  if (Status status = check(path, *file); !status.ok()) return status;
  return file;
}

std::string camera_json(const Camera& camera, double depth_scale_mm) {
  const Json json = {{"cx", camera.cx},      {"cy", camera.cy}, {"depth_scale", depth_scale_mm},
                     {"fx", camera.fx},      {"fy", camera.fy}, {"height", camera.height},
                     {"width", camera.width}};
  return json.dump(2) + "\n";
}

}  // namespace bpa::io
