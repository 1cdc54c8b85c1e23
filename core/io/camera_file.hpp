// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/geometry/camera.hpp"

namespace bpa::io {

/// What a camera file says.
struct CameraFile {
  Camera camera;              ///< width and height are 0 where the file does not say.
  double depth_scale_mm = 1;  ///< Millimetres of one unit of a depth image.
  /// Lens distortion of a ROS camera_info file: k1 k2 p1 p2 k3 ...; empty without.
  std::vector<double> distortion;
  std::string note;  ///< Something people should know (distortion ignored); else empty.
};

/// Reads a BOP camera.json (fx fy cx cy width height depth_scale; also cam_K instead of fx...) or a
/// ROS camera_info YAML (image_width, image_height, camera_matrix), by its extension. Fails with
/// not_found, corrupt, or invalid_argument naming the field and the rule.
Result<CameraFile> read_camera(const std::string& path);

/// The BOP form.
std::string camera_json(const Camera& camera, double depth_scale_mm);

}  // namespace bpa::io
