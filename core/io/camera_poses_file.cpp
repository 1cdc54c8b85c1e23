// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/camera_poses_file.hpp"

#include "core/io/private/json_file.hpp"

namespace bpa::io {

Result<std::vector<CameraPose>> read_camera_poses(const std::string& path) {
  using Cameras = std::vector<CameraPose>;
  return read_json(path, [&](const Json& file) -> Result<Cameras> {
    Cameras cameras;
    for (const Json& json : file.at("cameras")) {
      CameraPose camera{json.value("name", ""), json.at("scene_from_camera").get<Pose>()};
      if (!is_valid(camera.scene_from_camera)) {
        return invalid_argument(path, ": cameras[", cameras.size(),
                                "].scene_from_camera is no rigid motion: its numbers must be "
                                "finite and its quaternion of unit length");
      }
      cameras.push_back(std::move(camera));
    }
    return cameras;
  });
}

Status write_camera_poses(const std::string& path, const std::vector<CameraPose>& cameras) {
  Json list = Json::array();
  for (const CameraPose& camera : cameras) {
    list.push_back({{"name", camera.name}, {"scene_from_camera", camera.scene_from_camera}});
  }
  return write_file(path, written({{"cameras", list}}, 2) + "\n");
}

}  // namespace bpa::io
