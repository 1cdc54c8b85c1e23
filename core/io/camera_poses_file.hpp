// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/geometry/pose.hpp"

namespace bpa::io {

/// Where one camera of a scene is.
struct CameraPose {
  std::string name;  ///< For people, and the frame's frame_id; may be empty.
  Pose scene_from_camera;
};

/// Reads {"cameras": [CAMERA, ...]}, as `bpa calibrate` writes it, where a CAMERA has
///
///   "name"               text, which may be missing;
///   "scene_from_camera"  {"rotation_wxyz": [4], "translation_m": [3]}, of the optical frame.
///
/// Fails with not_found, or with corrupt: no JSON, or a missing or wrong field. Fails with
/// invalid_argument on a pose that is no rigid motion. The message names file and camera.
Result<std::vector<CameraPose>> read_camera_poses(const std::string& path);
/// Numbers survive to the last bit. Fails with unavailable.
Status write_camera_poses(const std::string& path, const std::vector<CameraPose>& cameras);

}  // namespace bpa::io
