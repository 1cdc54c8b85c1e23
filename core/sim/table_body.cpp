// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/private/table_body.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/sim/arms.hpp"
#include "core/sim/physics.hpp"
#include "core/sim/private/draws.hpp"

namespace bpa::sim {
namespace {

constexpr std::size_t kPoints = 2000;

struct Extent {
  double low = 1e9, high = -1e9;

  void extend(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double middle() const { return 0.5 * (low + high); }
  double width() const { return high - low; }
};

RestingBody fallen(const SimulatedObject& object, bool upright, RandomStream& random) {
  constexpr int kTries = 20;
  constexpr double kStill = 1e-3;  // m/s
  RestingBody rest;
  for (int i = 0; i < kTries; ++i) {
    const Eigen::Quaterniond rotation = upright ? turned(random) : start_rotation(random);
    rest = drop({{&object, {rotation, Eigen::Vector3d::Zero()}}}, {.fence_radius = 0.3}).front();
    const bool stands = rest.world_from_object.matrix()(2, 2) > 0.99;
    if (rest.on_table && rest.speed < kStill && (stands || !upright)) break;
  }
  return rest;
}

}  // namespace

Pose world_from_rest(const Place& place, double height) {
  return {rotation_from_vector(place.yaw * Eigen::Vector3d::UnitZ()),
          {place.at.x(), place.at.y(), height}};
}

TableBody body_at_rest(const Stage& stage, int mesh, bool upright, RandomStream& random) {
  const SimulatedObject& object = stage.body(mesh);
  TableBody body;
  body.mesh = mesh;
  body.rest_from_object = fallen(object, upright, random).world_from_object;
  const std::size_t step = object.mesh.vertices.size() / kPoints + 1;
  Extent x, y;
  for (std::size_t i = 0; i < object.mesh.vertices.size(); ++i) {
    const Eigen::Vector3d point =
        body.rest_from_object * Eigen::Vector3d(object.mesh.vertices[i].cast<double>());
    x.extend(point.x());
    y.extend(point.y());
    body.top = std::max(body.top, point.z());
    if (i % step == 0) body.points.push_back(point);
  }
  const Eigen::Vector3d shift(x.middle(), y.middle(), 0);
  body.rest_from_object.translation -= shift;
  for (Eigen::Vector3d& point : body.points) point -= shift;
  for (const Eigen::Vector3f& vertex : object.mesh.vertices) {
    const Eigen::Vector3d point = body.rest_from_object * Eigen::Vector3d(vertex.cast<double>());
    body.radius = std::max(body.radius, point.head<2>().norm());
    body.sphere = std::max(body.sphere, (point - body.middle()).norm());
  }
  for (const int vertex : object.telltales) {
    const Eigen::Vector3d telltale = object.mesh.vertices[vertex].cast<double>();
    body.telltale_side += (body.rest_from_object * telltale).head<2>();
  }
  if (!object.telltales.empty()) {
    // From the middle of the whole body, which the circle's centre is not.
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector3d& point : body.points) middle += point.head<2>();
    body.telltale_side /= static_cast<double>(object.telltales.size());
    body.telltale_side -= middle / static_cast<double>(body.points.size());
    body.telltale_side.normalize();
  }
  return body;
}

double reach(const TableBody& body, const Place& place, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d at_rest = Eigen::Rotation2Dd(-place.yaw) * direction;
  double farthest = 0;
  for (const Eigen::Vector3d& point : body.points) {
    farthest = std::max(farthest, at_rest.dot(point.head<2>()));
  }
  return farthest;
}

Pose Grip::turned() const {
  return rest_from_arm *
         Pose{Eigen::Quaterniond(0, 0, 0, 1), Eigen::Vector3d::Zero()};  // half a turn about z
}

std::optional<Grip> grip_of(const TableBody& body) {
  constexpr int kAngles = 24;
  constexpr double kPlay = 0.002;  // metres
  const double depth = std::min(kGripDepth - 0.01, 0.8 * body.top);
  std::optional<Grip> best;
  double narrowest = kGripWidths.back() - kPlay;
  for (int i = 0; i < kAngles; ++i) {
    const double angle = std::numbers::pi * i / kAngles;
    const Eigen::Vector3d across(std::cos(angle), std::sin(angle), 0);
    const Eigen::Vector3d along = -Eigen::Vector3d::UnitZ().cross(across);
    Extent x, y;
    for (const Eigen::Vector3d& point : body.points) {
      if (point.z() < body.top - depth) continue;
      x.extend(across.dot(point));
      y.extend(along.dot(point));
    }
    if (x.width() > narrowest) continue;
    narrowest = x.width();
    const auto wide_enough = std::ranges::lower_bound(kGripWidths, narrowest + kPlay);
    Eigen::Matrix3d axes;
    axes << across, along, -Eigen::Vector3d::UnitZ();
    best.emplace();
    best->arm = kFirstGrip + static_cast<int>(wide_enough - kGripWidths.begin());
    best->rest_from_arm =
        Pose::from_matrix(axes, x.middle() * across + y.middle() * along +
                                    (body.top - depth) * Eigen::Vector3d::UnitZ());
  }
  return best;
}

}  // namespace bpa::sim
