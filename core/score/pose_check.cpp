// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <bpa/core/score/pose_check.hpp>

namespace bpa {
namespace {

// Facing points after which a pose is looked at, and given up if it is hopeless. Most poses are, and
// go at the first look.
constexpr int kFirstLook = 8;
constexpr int kLastLook = 24;

bool hopeless(const PoseCheck& check) {
  if (check.facing == kFirstLook) {
    return check.seen > 4 && (check.agreeing == 0 || 2 * check.free_space > check.seen);
  }
  return check.seen > 8 && (5 * check.free_space > 2 * check.seen ||  //
                            5 * check.agreeing < check.seen);
}

}  // namespace

CheckImage make_check_image(const SurfaceMap& map) {
  CheckImage image;
  image.width = map.width();
  image.height = map.height();
  image.fx = static_cast<float>(map.camera.fx);
  image.fy = static_cast<float>(map.camera.fy);
  image.cx = static_cast<float>(map.camera.cx);
  image.cy = static_cast<float>(map.camera.cy);
  image.pixels.resize(map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    CheckPixel& pixel = image.pixels[i];
    pixel.depth = map.depth[i];
    pixel.searched = map.searched[i];
    for (int k = 0; k < 3; ++k) {
      pixel.normal[k] = static_cast<std::int8_t>(std::lround(127 * map.normals[i][k]));
    }
  }
  return image;
}

PoseCheck check_pose(const CheckImage& image, const CheckPoints& model, const FastPose& pose,
                     int count, const CheckTolerance& tolerance) {
  PoseCheck check;
  const int last = std::min(count, static_cast<int>(model.points.size()));
  const float cosine_127 = 127 * tolerance.normal_cosine;
  for (int k = 0; k < last; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Eigen::Vector3f normal = pose.rotation * model.normals[i];
    const Eigen::Vector3f point = pose.rotation * model.points[i] + pose.translation;
    if (point.z() < 0.1f || normal.dot(point) > -0.15f * point.z()) continue;
    const float inverse_z = 1 / point.z();
    const auto u = static_cast<int>(image.fx * point.x() * inverse_z + image.cx + 0.5f);
    const auto v = static_cast<int>(image.fy * point.y() * inverse_z + image.cy + 0.5f);
    if (u < 0 || v < 0 || u >= image.width || v >= image.height) continue;
    ++check.facing;
    const CheckPixel& pixel = image.pixels[static_cast<std::size_t>(v * image.width + u)];
    if (pixel.depth <= 0) continue;
    const float difference = pixel.depth - point.z();
    if (difference < -tolerance.depth) continue;  // hidden behind something
    ++check.seen;
    if (difference <= tolerance.depth) {
      const float cosine = normal.x() * pixel.normal[0] + normal.y() * pixel.normal[1] +
                           normal.z() * pixel.normal[2];
      check.agreeing += pixel.searched && cosine > cosine_127;
    } else if (difference > tolerance.free_depth) {
      ++check.free_space;
    }
    const bool look = check.facing == kFirstLook || check.facing == kLastLook;
    if (look && hopeless(check)) return check;
  }
  return check;
}

}  // namespace bpa
