// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/random.hpp"
#include "core/sim/physics.hpp"
#include "core/sim/private/stage.hpp"

namespace bpa::sim {
namespace {

constexpr double kPi = std::numbers::pi;

// Uniform over all orientations (Shoemake 1992).
Eigen::Quaterniond random_rotation(RandomStream& random) {
  const double u = random.uniform(), v = 2 * kPi * random.uniform(), w = 2 * kPi * random.uniform();
  const double a = std::sqrt(1 - u), b = std::sqrt(u);
  return {a * std::sin(v), a * std::cos(v), b * std::sin(w), b * std::cos(w)};
}

// Some household objects are put down, the others tumble.
Eigen::Quaterniond start_rotation(RandomStream& random) {
  constexpr double kUpright = 0.3;
  if (random.uniform() < kUpright) {
    return rotation_from_vector(random.uniform(-kPi, kPi) * Eigen::Vector3d::UnitZ());
  }
  return random_rotation(random);
}

std::vector<int> chosen_without_repetition(int count, int from, RandomStream& random) {
  std::vector<int> all(from);
  for (int i = 0; i < from; ++i) all[i] = i;
  for (int i = 0; i < std::min(count, from); ++i)
    std::swap(all[i], all[i + random.index(from - i)]);
  all.resize(std::min(count, from));
  return all;
}

// A point in a disc, the farther from those already taken the tidier the scene.
Eigen::Vector2d start_point(double radius, double clutter,
                            const std::vector<Eigen::Vector2d>& taken, RandomStream& random) {
  const int tries = 1 + static_cast<int>(std::lround(25 * (1 - clutter)));
  Eigen::Vector2d best = Eigen::Vector2d::Zero();
  double best_distance = -1;
  for (int i = 0; i < tries; ++i) {
    const double r = radius * std::sqrt(random.uniform()), a = 2 * kPi * random.uniform();
    const Eigen::Vector2d point(r * std::cos(a), r * std::sin(a));
    double distance = 1e9;
    for (const Eigen::Vector2d& other : taken) {
      distance = std::min(distance, (point - other).norm());
    }
    if (distance > best_distance) {
      best = point;
      best_distance = distance;
    }
  }
  return best;
}

SceneKind draw_kind(const SceneOptions& options, RandomStream& random) {
  double u = random.uniform();
  if ((u -= options.empty_share) < 0) return SceneKind::empty_table;
  if ((u -= options.distractor_share) < 0) return SceneKind::distractors;
  if ((u -= options.border_share) < 0) return SceneKind::border;
  return SceneKind::pile;
}

// A mesh of a scene: a household object, or a distractor (object -1).
struct Item {
  int mesh = 0;
  int object = -1;
  Material material;
  Pose world_from_object;
};

// The household objects of a pile, then its distractors; not placed yet.
std::vector<Item> choose_items(const Stage::Impl& stage, const SceneOptions& options,
                               SceneKind kind, RandomStream& random) {
  const int span = std::max(options.max_objects - options.min_objects, 0) + 1;
  int wanted = options.min_objects + random.index(span);
  if (kind == SceneKind::border) wanted = std::max(wanted, 1);
  int others = random.index(options.max_distractors + 1);
  if (kind == SceneKind::distractors) {
    others = std::max(3, wanted);
    wanted = 0;
  }
  std::vector<Item> items;
  for (const int i :
       chosen_without_repetition(wanted, static_cast<int>(stage.objects.size()), random)) {
    items.push_back({i, i, stage.objects[i].material, {}});
  }
  for (const int i :
       chosen_without_repetition(others, static_cast<int>(stage.distractors.size()), random)) {
    items.push_back({stage.first_distractor + i, -1, stage.distractors[i].material, {}});
  }
  return items;
}

// Chooses what falls where, and lets it fall.
std::vector<Item> make_pile(const Stage::Impl& stage, const SceneOptions& options, SceneKind kind,
                            RandomStream& random) {
  if (kind == SceneKind::empty_table) return {};
  const std::vector<Item> items = choose_items(stage, options, kind, random);
  // Heaps are the harder and the commoner case.
  const double clutter = options.min_clutter +
                         (options.max_clutter - options.min_clutter) * std::sqrt(random.uniform());
  const double share = std::sqrt(static_cast<double>(items.size()) / 14);
  const double radius = share * (0.36 + clutter * (0.08 - 0.36)) + 0.02;
  const bool in_bin = random.uniform() < options.bin_share * clutter;
  std::vector<Eigen::Vector2d> taken;
  std::vector<FallingBody> bodies;
  for (const Item& item : items) {
    const SimulatedObject& body = item.object >= 0
                                      ? stage.objects[item.object]
                                      : stage.distractors[item.mesh - stage.first_distractor];
    taken.push_back(start_point(radius, clutter, taken, random));
    const Eigen::Vector3d start(taken.back().x(), taken.back().y(), 0.05);
    bodies.push_back({&body, {start_rotation(random), start}});
  }
  DropOptions drop_options;
  drop_options.table_half_x = kTableHalfX;
  drop_options.table_half_y = kTableHalfY;
  drop_options.fence_radius = in_bin ? kBinHalfY : std::max(radius + 0.07, 0.13);
  if (in_bin) drop_options.fixture = &stage.bin;
  const std::vector<RestingBody> resting = drop(bodies, drop_options);
  std::vector<Item> kept;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!resting[i].on_table) continue;
    kept.push_back(items[i]);
    kept.back().world_from_object = resting[i].world_from_object;
  }
  if (in_bin) kept.push_back({stage.bin_mesh, -1, stage.bin.material, {}});
  return kept;
}

Shading draw_shading(RandomStream& random) {
  Shading shading;
  shading.lights.clear();
  for (int i = 0; i < 2; ++i) {
    Light light;
    const double angle = 2 * kPi * random.uniform(), reach = random.uniform(0.3, 1.6);
    light.position = {reach * std::cos(angle), reach * std::sin(angle), random.uniform(1.4, 2.2)};
    light.power = random.uniform(0.25, 0.5);
    shading.lights.push_back(light);
  }
  shading.ambient = random.uniform(0.35, 0.55);
  return shading;
}

// Turns the camera so that one object's centre falls on the left or right border.
Pose aimed_past(const Pose& world_from_camera, const Eigen::Vector3d& object, const Camera& camera,
                bool left) {
  const Eigen::Vector2d pixel = camera.project(world_from_camera.inverse() * object);
  const double border = left ? 0 : camera.width - 1;
  const double angle =
      std::atan((pixel.x() - camera.cx) / camera.fx) - std::atan((border - camera.cx) / camera.fx);
  const Pose turn{rotation_from_vector(angle * Eigen::Vector3d::UnitY()), Eigen::Vector3d::Zero()};
  return world_from_camera * turn;
}

Pose draw_camera(const std::vector<Item>& items, const SceneOptions& options, SceneKind kind,
                 double azimuth, RandomStream& random) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Item& item : items) {
    middle += item.world_from_object.translation / static_cast<double>(items.size());
  }
  const Eigen::Vector3d target(middle.x() + 0.03 * random.normal(),
                               middle.y() + 0.03 * random.normal(), middle.z());
  const double distance = random.uniform(options.min_distance, options.max_distance);
  const double elevation =
      random.uniform(options.min_elevation_deg, options.max_elevation_deg) * kPi / 180;
  const Pose pose = camera_looking_at(target, distance, elevation, azimuth, 0.05 * random.normal());
  if (kind != SceneKind::border) return pose;
  // The outermost object on one side, so that the others stay in view.
  const bool left = random.uniform() < 0.5;
  const Item* outermost = nullptr;
  double farthest = -std::numeric_limits<double>::infinity();
  for (const Item& item : items) {
    const double u =
        options.camera.project(pose.inverse() * item.world_from_object.translation).x();
    if (item.object < 0 || (left ? -u : u) < farthest) continue;
    farthest = left ? -u : u;
    outermost = &item;
  }
  if (outermost == nullptr) return pose;
  return aimed_past(pose, outermost->world_from_object.translation, options.camera, left);
}

}  // namespace

Pose camera_looking_at(const Eigen::Vector3d& target, double distance, double elevation,
                       double azimuth, double roll) {
  const Eigen::Vector3d back(std::cos(elevation) * std::cos(azimuth),
                             std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  Eigen::Matrix3d axes;
  axes.col(2) = -back;
  axes.col(0) = axes.col(2).cross(Eigen::Vector3d::UnitZ()).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  const Pose turn{rotation_from_vector(roll * Eigen::Vector3d::UnitZ()), Eigen::Vector3d::Zero()};
  return Pose::from_matrix(axes, target + distance * back) * turn;
}

std::uint64_t scene_seed(std::uint64_t set_seed, int index) {
  return RandomStream(set_seed, static_cast<std::uint64_t>(index))();
}

SimulatedScene simulate_scene(const Stage& stage, const SceneOptions& options, std::uint64_t seed,
                              int num_threads) {
  RandomStream random(seed, 0);
  SimulatedScene result;
  result.kind = draw_kind(options, random);
  const std::vector<Item> items = make_pile(stage.impl(), options, result.kind, random);

  // Objects first, so that posed meshes and instances agree.
  std::vector<PosedMesh> posed;
  Shading shading = draw_shading(random);
  std::vector<int> objects;
  const auto place = [&](const Item& item) {
    posed.push_back({item.mesh, item.world_from_object});
    shading.materials.push_back(item.material);
  };
  for (const Item& item : items) {
    if (item.object < 0) continue;
    objects.push_back(item.object);
    place(item);
  }
  for (const Item& item : items) {
    if (item.object < 0) place(item);
  }
  const int table = random.index(static_cast<int>(stage.impl().tables.size()));
  place({stage.impl().first_table + table, -1, stage.impl().tables[table].material, {}});
  place({stage.impl().room_mesh, -1, stage.impl().room.material, {}});

  const RayScene scene(stage.impl().meshes(), posed);
  const double first_azimuth = random.uniform(0, 2 * kPi);
  for (int view = 0; view < options.views; ++view) {
    RandomStream view_random(seed, 1 + static_cast<std::uint64_t>(view));
    const double azimuth = first_azimuth + 2 * kPi * view / options.views;
    const Pose world_from_camera = draw_camera(items, options, result.kind, azimuth, view_random);
    const std::uint64_t view_seed = view_random();
    for (int shot = 0; shot < options.shots; ++shot) {
      result.frames.push_back(capture({scene, shading, options.camera, world_from_camera}, objects,
                                      options.kinect, view_seed, shot, num_threads));
    }
  }
  return result;
}

}  // namespace bpa::sim
