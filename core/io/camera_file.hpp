// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/geometry/camera.hpp"

namespace bpa::io {

/// What a camera file says.
struct CameraFile {
  Camera camera;  ///< width and height are 0 where the file does not say.
  std::optional<Camera>
      rectified;                   ///< Of rectified images: the projection matrix P, if it has one.
  double depth_scale_mm = 1;       ///< Millimetres of one unit of a depth image.
  std::vector<double> distortion;  ///< Lens distortion: k1 k2 p1 p2 k3 ...; empty without.
  std::string distortion_model;    ///< As the file names it; empty where it does not.
  std::vector<std::string> unread;  ///< Keys that nothing here knows.
};

/// Reads a camera, by its content: fx fy cx cy or a 3 x 3 matrix under one of their usual names,
/// with width, height and depth_scale where they are, as JSON, YAML or ini. So a BOP camera.json or
/// scene_camera.json (whose cameras are equal), a ROS camera_info of calibrators and of `ros2 topic
/// echo`, Open3D, librealsense, ORB-SLAM, NeRF's transforms.json, OpenCV's FileStorage as YAML or
/// XML; and bare numbers: fx fy cx cy,
/// or the matrix row by row. Fails with not_found, corrupt, or invalid_argument naming field and
/// rule; the message ends with the form that is accepted, filled with the numbers that were found.
Result<CameraFile> read_camera(const std::string& path);

/// k1 k2 p1 p2 k3 ... of its lens. Fails as lens_of() does, and with unsupported for equidistant.
Result<std::vector<double>> plumb_bob_of(const CameraFile& file);

/// What people should know of images that are read with it: keys that are not read, and what
/// becomes of its distortion, such as "is taken out of the images".
std::vector<std::string> notes_of(const CameraFile& file, const char* distortion);

/// The BOP form.
std::string camera_json(const Camera& camera, double depth_scale_mm);

}  // namespace bpa::io
