// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/turntable.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/random.hpp"
#include "core/sim/physics.hpp"
#include "core/sim/scenery.hpp"

namespace bpa::sim {
namespace {

using std::numbers::pi;
constexpr double kPlateHeight = 0.02;

// A pose with the lowest vertex at z = 0 and the middle of the bounding box over the origin.
Pose set_down(const SimulatedObject& object, const Eigen::Quaterniond& rotation) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& v : object.mesh.vertices) box.extend(rotation * v.cast<double>());
  const Eigen::Vector3d center = box.center();
  return {rotation, {-center.x(), -center.y(), -box.min().z()}};
}

// The direction of the object that points up.
Eigen::Vector3d up_of(const Pose& pose) {
  return pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
}

}  // namespace

std::vector<Pose> resting_poses(const SimulatedObject& object, int count, std::uint64_t seed) {
  constexpr int kTrials = 12;
  constexpr double kSlow = 0.05;  // m/s and rad/s
  std::vector<Pose> candidates;
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomStream random(seed, static_cast<std::uint64_t>(trial));
    FallingBody body{&object, {}};
    // The first trial stands upright; the others are uniform over all orientations.
    if (trial > 0) {
      Eigen::Vector4d q;
      for (int i = 0; i < 4; ++i) q[i] = random.normal();
      body.world_from_object.rotation = from_wxyz(q);
    }
    const RestingBody rest = drop({body}, {.max_seconds = 6}).front();
    if (!rest.on_table || rest.speed > kSlow || rest.turning > kSlow) continue;
    candidates.push_back(set_down(object, rest.world_from_object.rotation));
  }
  if (candidates.empty()) candidates.push_back(set_down(object, Eigen::Quaterniond::Identity()));
  std::vector<Pose> chosen{candidates.front()};
  while (static_cast<int>(chosen.size()) < count) {
    const Pose* best = nullptr;
    double best_cosine = std::cos(pi / 6);  // at least 30 degrees apart
    for (const Pose& candidate : candidates) {
      double cosine = -1;
      for (const Pose& other : chosen) {
        cosine = std::max(cosine, up_of(candidate).dot(up_of(other)));
      }
      if (cosine >= best_cosine) continue;
      best_cosine = cosine;
      best = &candidate;
    }
    if (best == nullptr) break;
    chosen.push_back(*best);
  }
  return chosen;
}

TurntableScan simulate_turntable(const SimulatedObject& object, const TurntableOptions& options,
                                 std::uint64_t seed, int num_threads) {
  const std::vector<Pose> rests = resting_poses(object, options.resting_positions, seed);
  const SimulatedObject plate = make_turntable_plate(options.plate_radius, kPlateHeight);
  const std::vector<SimulatedObject> tables = make_tables();
  const SimulatedObject& table = tables[1];
  const SimulatedObject room = make_room();
  const RayMeshes meshes({&object.mesh, &plate.mesh, &table.mesh, &room.mesh});

  RandomStream random(seed, 1000);
  const auto off_center = [&random, &options]() -> Eigen::Vector3d {
    const double y = random.uniform(-1, 1);
    const double x = random.uniform(-1, 1);
    return Eigen::Vector3d(x, y, 0) * options.spread;
  };
  const Pose world_from_camera =
      camera_looking_at(Eigen::Vector3d(0, 0, 0.05), options.distance,
                        options.elevation_deg * pi / 180, 0, 0.03 * random.normal());
  const Eigen::Vector3d axis_point = off_center();
  Shading shading;
  shading.lights = {{{0.8, -0.6, 1.8}, 0.4}, {{0.5, 0.9, 1.6}, 0.3}};
  shading.materials = {object.material, plate.material, table.material, room.material};
  const Pose below{Eigen::Quaterniond::Identity(), {0, 0, -kPlateHeight}};

  TurntableScan scan;
  const Pose camera_from_world = world_from_camera.inverse();
  scan.axis_in_camera = {camera_from_world.rotation * Eigen::Vector3d::UnitZ(),
                         camera_from_world * axis_point};
  const int full_turn = static_cast<int>(std::lround(360 / options.step_deg));
  const int per_rest = std::min(full_turn, options.max_views / static_cast<int>(rests.size()));
  for (std::size_t rest = 0; rest < rests.size(); ++rest) {
    const Pose plate_from_object =
        Pose{rotation_from_vector(random.uniform(-pi, pi) * Eigen::Vector3d::UnitZ()),
             off_center()} *
        rests[rest];
    for (int view = 0; view < per_rest; ++view) {
      const double turn = options.step_deg * pi / 180 * view;
      const Pose world_from_plate{rotation_from_vector(turn * Eigen::Vector3d::UnitZ()),
                                  axis_point};
      const RayScene scene(meshes, {{0, world_from_plate * plate_from_object},
                                    {1, world_from_plate},
                                    {2, below},
                                    {3, Pose{}}});
      const SensorView seen{scene, shading, options.camera, world_from_camera};
      scan.views.push_back({static_cast<int>(rest), turn,
                            capture(seen, {0}, options.sensor, random(), 0, num_threads)});
    }
  }
  return scan;
}

}  // namespace bpa::sim
