// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/private/telltales.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/random.hpp"

namespace bpa::sim {
namespace {

constexpr int kChecked = 500;  // vertices at most

/// Vertices in sight, as a share of those asked for.
double share_in_sight(const SimulatedObject& object, const std::vector<int>& vertices,
                      const RayScene& scene, const Camera& camera, const Pose& world_from_camera) {
  const Pose world_from_object = scene.instances().front().world_from_mesh;
  const Pose camera_from_object = world_from_camera.inverse() * world_from_object;
  const Eigen::Vector3f eye = world_from_camera.translation.cast<float>();
  const std::size_t step = vertices.size() / kChecked + 1;
  int seen = 0, checked = 0;
  for (std::size_t i = 0; i < vertices.size(); i += step, ++checked) {
    const Eigen::Vector3d vertex = object.mesh.vertices[vertices[i]].cast<double>();
    const Eigen::Vector3d in_camera = camera_from_object * vertex;
    if (in_camera.z() <= 0) continue;
    const Eigen::Vector2d pixel = camera.project(in_camera);
    const bool inside = pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < camera.width - 0.5 &&
                        pixel.y() < camera.height - 0.5;
    seen += inside && !scene.blocked(eye, (world_from_object * vertex).cast<float>());
  }
  return checked > 0 ? static_cast<double>(seen) / checked : 0;
}

/// A circle as seen from above, metres.
struct WallCircle {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double radius = 0;

  /// From the wall: negative inside.
  double beyond(const Eigen::Vector3f& vertex) const {
    return (vertex.head<2>().cast<double>() - center).norm() - radius;
  }
};

/// Through three points; radius 0 where they are on one line.
WallCircle circle_through(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                          const Eigen::Vector2d& c) {
  Eigen::Matrix2d sides;
  sides << (b - a).transpose(), (c - a).transpose();
  if (std::abs(sides.determinant()) < 1e-9) return {};
  const Eigen::Vector2d halves(0.5 * (b - a).squaredNorm(), 0.5 * (c - a).squaredNorm());
  const Eigen::Vector2d to_center = sides.inverse() * halves;
  return {a + to_center, to_center.norm()};
}

}  // namespace

std::vector<int> protruding_vertices(const TriangleMesh& mesh) {
  constexpr int kTriples = 500;
  constexpr std::size_t kSample = 1000;
  constexpr double kOnWall = 0.005, kStandsOut = 0.01;                     // metres
  constexpr double kLeastOnWall = 0.25, kLeastOut = 0.02, kMostOut = 0.4;  // shares
  constexpr double kOneSide = 0.7;   // mean resultant length of the directions that stand out
  constexpr double kSameSide = 0.5;  // cosine of an angle to the middle of them
  if (mesh.vertices.empty()) return {};
  RandomStream random(1);
  std::vector<Eigen::Vector3f> sample;
  for (std::size_t i = 0; i < kSample; ++i) {
    sample.push_back(mesh.vertices[random.index(static_cast<int>(mesh.vertices.size()))]);
  }
  const auto draw = [&] {
    return Eigen::Vector2d(sample[random.index(kSample)].head<2>().cast<double>());
  };
  WallCircle wall;
  double most = kLeastOnWall;
  for (int i = 0; i < kTriples; ++i) {
    const Eigen::Vector2d a = draw(), b = draw(), c = draw();
    const WallCircle circle = circle_through(a, b, c);
    const auto on_wall = std::ranges::count_if(sample, [&](const Eigen::Vector3f& vertex) {
      return std::abs(circle.beyond(vertex)) < kOnWall;
    });
    const double share = static_cast<double>(on_wall) / kSample;
    if (circle.radius == 0 || share <= most) continue;
    most = share;
    wall = circle;
  }
  std::vector<int> out;
  Eigen::Vector2d directions = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (wall.beyond(mesh.vertices[i]) < kStandsOut) continue;
    out.push_back(static_cast<int>(i));
    directions += (mesh.vertices[i].head<2>().cast<double>() - wall.center).normalized();
  }
  const auto count = static_cast<double>(out.size());
  const double share = count / static_cast<double>(mesh.vertices.size());
  if (wall.radius == 0 || share < kLeastOut || share > kMostOut) return {};
  // The corners of a box stand out to all sides.
  if (directions.norm() < kOneSide * count) return {};
  // A dent or lip on another side does not tell the sides apart.
  std::erase_if(out, [&](int vertex) {
    const Eigen::Vector2d out_of_wall =
        mesh.vertices[vertex].head<2>().cast<double>() - wall.center;
    return out_of_wall.normalized().dot(directions.normalized()) < kSameSide;
  });
  return out;
}

double telltales_in_sight(const SimulatedObject& object, const RayScene& scene,
                          const Camera& camera, const Pose& world_from_camera) {
  return share_in_sight(object, object.telltales, scene, camera, world_from_camera);
}

bool telltales_hidden(const SimulatedObject& object, const RayScene& scene, const Camera& camera,
                      const Pose& world_from_camera) {
  constexpr double kEnough = 0.1;  // half of the outside of a vessel is some 0.25
  std::vector<int> all(object.mesh.vertices.size());
  std::iota(all.begin(), all.end(), 0);
  return telltales_in_sight(object, scene, camera, world_from_camera) == 0 &&
         share_in_sight(object, all, scene, camera, world_from_camera) > kEnough;
}

}  // namespace bpa::sim
