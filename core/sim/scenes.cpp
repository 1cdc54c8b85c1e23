// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/random.hpp"
#include "core/sim/physics.hpp"
#include "core/sim/private/draws.hpp"
#include "core/sim/private/telltales.hpp"
#include "core/sim/scenery.hpp"

namespace bpa::sim {
namespace {

using std::numbers::pi;
constexpr int kAmbiguousDraws = 1000;  // of the camera; about one of 15 will do

// A point in a disc, the farther from those already taken the tidier the scene.
Eigen::Vector2d start_point(double radius, double clutter,
                            const std::vector<Eigen::Vector2d>& taken, RandomStream& random) {
  const int tries = 1 + static_cast<int>(std::lround(25 * (1 - clutter)));
  Eigen::Vector2d best = Eigen::Vector2d::Zero();
  double best_distance = -1;
  for (int i = 0; i < tries; ++i) {
    const double r = radius * std::sqrt(random.uniform()), a = 2 * pi * random.uniform();
    const Eigen::Vector2d point(r * std::cos(a), r * std::sin(a));
    double distance = 1e9;
    for (const Eigen::Vector2d& other : taken) {
      distance = std::min(distance, (point - other).norm());
    }
    if (distance <= best_distance) continue;
    best = point;
    best_distance = distance;
  }
  return best;
}

SceneKind draw_kind(const SceneOptions& options, RandomStream& random) {
  double u = random.uniform();
  if ((u -= options.empty_share) < 0) return SceneKind::empty_table;
  if ((u -= options.distractor_share) < 0) return SceneKind::distractors;
  if ((u -= options.border_share) < 0) return SceneKind::border;
  if ((u -= options.ambiguous_share) < 0) return SceneKind::ambiguous;
  if ((u -= options.equal_share) < 0) return SceneKind::equal;
  return SceneKind::pile;
}

// One of the objects that have telltales.
int choose_ambiguous(const Stage& stage, RandomStream& random) {
  std::vector<int> candidates;
  for (int i = 0; i < static_cast<int>(stage.objects().size()); ++i) {
    if (!stage.objects()[i].telltales.empty()) candidates.push_back(i);
  }
  return candidates.at(random.index(static_cast<int>(candidates.size())));
}

// Copies of one to max_kinds objects, of the first ones more than of the last.
std::vector<int> choose_copies(int wanted, int objects, int max_kinds, RandomStream& random) {
  std::vector<int> kinds{random.index(objects)};
  if (max_kinds == 1) return std::vector<int>(wanted, kinds.front());
  const int count = 1 + random.index(max_kinds);
  while (std::ssize(kinds) < count) kinds.push_back(random.index(objects));
  std::vector<int> bodies;
  while (std::ssize(bodies) < wanted) {
    const double u = random.uniform();
    bodies.push_back(kinds[static_cast<std::size_t>(u * u * count)]);
  }
  return bodies;
}

// Meshes of the household objects of a pile, then of its distractors.
std::vector<int> choose_bodies(const Stage& stage, const SceneOptions& options, SceneKind kind,
                               RandomStream& random) {
  const int span = std::max(options.max_objects - options.min_objects, 0) + 1;
  int wanted = options.min_objects + random.index(span);
  if (kind == SceneKind::border) wanted = std::max(wanted, 1);
  const int more = std::max(options.max_distractors - options.min_distractors, 0);
  int others = options.min_distractors + random.index(more + 1);
  if (kind == SceneKind::distractors) {
    others = std::max(3, wanted);
    wanted = 0;
  }
  const int objects = static_cast<int>(stage.objects().size());
  const int distractors = static_cast<int>(stage.scenery().size()) - kFirstDistractor;
  std::vector<int> bodies;
  if (kind == SceneKind::ambiguous) {
    bodies = {choose_ambiguous(stage, random)};
  } else if (kind == SceneKind::equal) {
    bodies = choose_copies(wanted, objects, options.max_kinds, random);
  } else {
    bodies = chosen_without_repetition(wanted, objects, random);
  }
  for (const int i : chosen_without_repetition(others, distractors, random)) {
    bodies.push_back(objects + kFirstDistractor + i);
  }
  return bodies;
}

// Chooses what falls where, and lets it fall.
std::vector<PosedMesh> make_pile(const Stage& stage, const SceneOptions& options, SceneKind kind,
                                 RandomStream& random) {
  if (kind == SceneKind::empty_table) return {};
  const std::vector<int> chosen = choose_bodies(stage, options, kind, random);
  // Heaps are the harder and the commoner case.
  const double clutter = options.min_clutter +
                         (options.max_clutter - options.min_clutter) * std::sqrt(random.uniform());
  const double share = std::sqrt(static_cast<double>(chosen.size()) / 14);
  const double radius = share * (0.36 + clutter * (0.08 - 0.36)) + 0.02;
  const bool ambiguous = kind == SceneKind::ambiguous;
  const bool in_bin = random.uniform() < options.bin_share * clutter && !ambiguous;
  std::vector<Eigen::Vector2d> taken;
  std::vector<FallingBody> bodies;
  for (const int mesh : chosen) {
    taken.push_back(start_point(radius, clutter, taken, random));
    const Eigen::Vector3d start(taken.back().x(), taken.back().y(), 0.05);
    const bool upright = ambiguous && bodies.empty();
    const Eigen::Quaterniond rotation = upright ? turned(random) : start_rotation(random);
    bodies.push_back({&stage.body(mesh), {rotation, start}});
  }
  const std::vector<RestingBody> resting =
      drop(bodies, {.table_half_x = kTableHalfX,
                    .table_half_y = kTableHalfY,
                    .fence_radius = in_bin ? kBinHalfY : std::max(radius + 0.07, 0.13),
                    .fixture = in_bin ? &stage.scenery()[kBin] : nullptr});
  std::vector<PosedMesh> pile;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (resting[i].on_table) pile.push_back({chosen[i], resting[i].world_from_object});
  }
  if (in_bin) pile.push_back({static_cast<int>(stage.objects().size()) + kBin, Pose{}});
  return pile;
}

// Whether an object is first and stands: its telltales are beside it then, not on top.
bool object_stands(const Stage& stage, const std::vector<PosedMesh>& pile) {
  constexpr double kUpright = 0.99;
  return !pile.empty() && pile.front().mesh < static_cast<int>(stage.objects().size()) &&
         pile.front().world_from_mesh.rotation.toRotationMatrix()(2, 2) > kUpright;
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

SensorOptions draw_sensor(const SceneOptions& options, std::uint64_t seed) {
  constexpr std::uint64_t kStream = 1u << 20;  // beyond those of the views
  SensorOptions sensor = options.sensor;
  if (options.mixed_sensors) {
    sensor.kind = static_cast<SensorKind>(RandomStream(seed, kStream).index(kSensorKinds.size()));
  }
  return sensor;
}

Camera draw_lens(const SceneOptions& options, RandomStream& random) {
  Camera camera = options.camera;
  if (options.max_focal > 0) {
    camera.fx = camera.fy = random.uniform(options.min_focal, options.max_focal);
  }
  return camera;
}

// Of the camera in the world. The first `num_objects` of the pile are household objects.
Pose draw_pose(const std::vector<PosedMesh>& pile, std::size_t num_objects, const Camera& camera,
               const SceneOptions& options, SceneKind kind, double azimuth, RandomStream& random) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const PosedMesh& body : pile) {
    middle += body.world_from_mesh.translation / static_cast<double>(pile.size());
  }
  // One draw a line, here and elsewhere: compilers draw arguments in different orders.
  const double beside_y = 0.03 * random.normal();
  const double beside_x = 0.03 * random.normal();
  const Eigen::Vector3d target = middle + Eigen::Vector3d(beside_x, beside_y, 0);
  const double distance = random.uniform(options.min_distance, options.max_distance);
  const double elevation =
      random.uniform(options.min_elevation_deg, options.max_elevation_deg) * pi / 180;
  const Pose pose = camera_looking_at(target, distance, elevation, azimuth, 0.05 * random.normal());
  if (kind != SceneKind::border) return pose;
  // The outermost object on one side, so that the others stay in view.
  const bool left = random.uniform() < 0.5;
  if (num_objects == 0) return pose;
  const auto outward = [&](const PosedMesh& body) {
    const Eigen::Vector3d in_camera = pose.inverse() * body.world_from_mesh.translation;
    return (left ? -1 : 1) * camera.project(in_camera).x();
  };
  const PosedMesh& outermost =
      *std::ranges::max_element(pile.begin(), pile.begin() + num_objects, {}, outward);
  return aimed_past(pose, outermost.world_from_mesh.translation, camera, left);
}

}  // namespace

Camera camera_of_size(int width, int height) {
  constexpr double kFocalPerWidth = 525.0 / 640;
  const double focal = kFocalPerWidth * width;
  return {width, height, focal, focal, (width - 1) / 2.0, (height - 1) / 2.0};
}

Stage::Stage(std::vector<SimulatedObject> objects, int num_threads,
             std::vector<SimulatedObject> look_alikes)
    : objects_(std::move(objects)) {
  scenery_ = {make_room(), make_bin()};
  for (auto&& more : {make_tables(), make_distractors(num_threads), std::move(look_alikes)}) {
    scenery_.insert(scenery_.end(), more.begin(), more.end());
  }
  std::vector<const TriangleMesh*> meshes;
  for (const SimulatedObject& object : objects_) meshes.push_back(&object.mesh);
  for (const SimulatedObject& object : scenery_) meshes.push_back(&object.mesh);
  meshes_ = std::make_unique<RayMeshes>(meshes);
}

const SimulatedObject& Stage::body(int mesh) const {
  const auto index = static_cast<std::size_t>(mesh);
  return index < objects_.size() ? objects_[index] : scenery_[index - objects_.size()];
}

SimulatedFrame capture(const SensorView& view, const std::vector<int>& objects,
                       const SensorOptions& options, std::uint64_t seed, int shot,
                       int num_threads) {
  SensorImage image = simulate_sensor(view, options, seed, shot, num_threads);
  SimulatedFrame frame;
  frame.frame = std::move(image.frame);
  frame.camera_from_world = view.world_from_camera.inverse();
  const int count = static_cast<int>(objects.size());
  const std::vector<InstanceVisibility> seen =
      visibility(view.scene, image.ideal, view.camera, view.world_from_camera, count, num_threads);
  for (int i = 0; i < count; ++i) {
    frame.instances.push_back(
        {objects[i], frame.camera_from_world * view.scene.instances()[i].world_from_mesh, seen[i]});
  }
  frame.instance_image.reserve(image.ideal.instance.size());
  for (const std::int32_t instance : image.ideal.instance) {
    frame.instance_image.push_back(static_cast<std::int16_t>(instance < count ? instance : -1));
  }
  frame.ideal_depth = std::move(image.ideal.depth);
  return frame;
}

std::vector<std::uint8_t> visible_mask(const SimulatedFrame& frame, int instance) {
  std::vector<std::uint8_t> mask;
  mask.reserve(frame.instance_image.size());
  for (const std::int16_t i : frame.instance_image) mask.push_back(i == instance ? 255 : 0);
  return mask;
}

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
  const SensorOptions sensor = draw_sensor(options, seed);
  result.sensor = sensor.kind;
  std::vector<PosedMesh> pile = make_pile(stage, options, result.kind, random);
  while (result.kind == SceneKind::ambiguous && !object_stands(stage, pile)) {
    pile = make_pile(stage, options, result.kind, random);
  }
  Shading shading = draw_shading(random);
  const int num_objects = static_cast<int>(stage.objects().size());
  std::vector<PosedMesh> posed = pile;
  posed.push_back({num_objects + kFirstTable + random.index(kNumTables), Pose{}});
  posed.push_back({num_objects + kRoom, Pose{}});
  std::vector<int> objects;  // of the instances, which come first
  for (const PosedMesh& body : posed) {
    shading.materials.push_back(stage.body(body.mesh).material);
    if (body.mesh < num_objects) objects.push_back(body.mesh);
  }
  const RayScene scene(stage.meshes(), posed);
  const double first_azimuth = random.uniform(0, 2 * pi);
  for (int view = 0; view < options.views; ++view) {
    RandomStream view_random(seed, 1 + static_cast<std::uint64_t>(view));
    const double azimuth = first_azimuth + 2 * pi * view / options.views;
    const Camera camera = draw_lens(options, view_random);
    const auto draw = [&](double from) {
      return draw_pose(pile, objects.size(), camera, options, result.kind, from, view_random);
    };
    Pose world_from_camera = draw(azimuth);
    for (int i = 0; i < kAmbiguousDraws && result.kind == SceneKind::ambiguous; ++i) {
      const SimulatedObject& object = stage.objects()[objects.front()];
      if (telltales_hidden(object, scene, camera, world_from_camera)) break;
      world_from_camera = draw(view_random.uniform(0, 2 * pi));
    }
    const std::uint64_t view_seed = view_random();
    for (int shot = 0; shot < options.shots; ++shot) {
      result.frames.push_back(capture({scene, shading, camera, world_from_camera}, objects, sensor,
                                      view_seed, shot, num_threads));
    }
  }
  return result;
}

}  // namespace bpa::sim
