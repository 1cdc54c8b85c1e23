// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/sim/objects.hpp"
#include "core/sim/render.hpp"
#include "core/sim/sensor.hpp"

// Whole scenes: objects fall on a table and are seen from a robot's viewpoints, with the truth.

namespace bpa::sim {

/// What a scene is made of.
enum class SceneKind {
  pile,         ///< Objects, from apart on the table to a heap, and perhaps a few distractors.
  empty_table,  ///< Nothing on the table.
  distractors,  ///< Distractors only.
  border,       ///< A pile of which one object is cut by the image's border.
  ambiguous,    ///< One object whose telltales are out of sight, and perhaps a few distractors.
  equal,        ///< A pile of copies of one object, and perhaps a few distractors.
};

/// A camera whose images span 62.7 degrees from left to right, as those of a Kinect.
Camera camera_of_size(int width, int height);

/// The ranges that scenes are drawn from.
struct SceneOptions {
  BPA_OPTION(int, min_objects, 10, (0, 100), "Fewest objects in a pile.");
  BPA_OPTION(int, max_objects, 14, (0, 100), "Most objects in a pile.");
  BPA_OPTION(double, min_clutter, 0.6, (0, 1), "0 = apart on the table, 1 = a heap.");
  BPA_OPTION(double, max_clutter, 1, (0, 1), "0 = apart on the table, 1 = a heap.");
  BPA_OPTION(double, bin_share, 1, (0, 1), "Chance that a heap lies in an open bin.");
  BPA_OPTION(int, min_distractors, 0, (0, 20), "Fewest distractors in a pile.");
  BPA_OPTION(int, max_distractors, 2, (0, 20), "Most distractors in a pile.");
  BPA_OPTION(double, min_distance, 0.6, (0.3, 4), "Camera to the middle of the pile, metres.");
  BPA_OPTION(double, max_distance, 1.4, (0.3, 4), "Camera to the middle of the pile, metres.");
  BPA_OPTION(double, min_elevation_deg, 25, (5, 89), "Camera above the table, degrees.");
  BPA_OPTION(double, max_elevation_deg, 65, (5, 89), "Camera above the table, degrees.");
  BPA_OPTION(int, views, 1, (1, 1000), "Viewpoints of each scene, all around.");
  BPA_OPTION(int, shots, 1, (1, 100), "Frames from each viewpoint, which differ in noise.");
  BPA_OPTION(double, empty_share, 0, (0, 1), "Share of scenes with an empty table.");
  BPA_OPTION(double, distractor_share, 0, (0, 1), "Share of scenes with distractors only.");
  BPA_OPTION(double, border_share, 0.1, (0, 1),
             "Share of scenes with an object cut by the image's border.");
  BPA_OPTION(double, ambiguous_share, 0, (0, 1),
             "Share of scenes with one mug whose handle is out of sight.");
  BPA_OPTION(double, equal_share, 0, (0, 1),
             "Share of scenes whose objects are copies of one, or of up to max_kinds.");
  BPA_OPTION(int, max_kinds, 1, (1, 100), "Most objects that such a scene holds copies of.");
  BPA_OPTION(double, min_focal, 0, (0, 4000), "Shortest focal length, pixels.");
  BPA_OPTION(double, max_focal, 0, (0, 4000), "Longest focal length; 0 = the camera's own.");
  Camera camera{640, 480, 525, 525, 319.5, 239.5};  ///< Of the colour image and the frame.
  BPA_INLINE_GROUP(SensorOptions, sensor);
  BPA_OPTION(bool, mixed_sensors, false, (0, 1),
             "Each scene takes one of the three kinds of sensors by its seed.");
};

/// One object in one frame.
struct SimulatedInstance {
  int object = 0;  ///< Index in the stage's objects.
  Pose camera_from_object;
  InstanceVisibility visibility;
};

/// What one view gives, with the truth.
struct SimulatedFrame {
  Frame frame;
  Pose camera_from_world;                    ///< The table is z = 0, z up.
  std::vector<SimulatedInstance> instances;  ///< All that lie on the table, seen or not.
  std::vector<std::int16_t> instance_image;  ///< Row-major: index in `instances`, or -1.
  std::vector<float> ideal_depth;            ///< Row-major, metres, without any error.
};

/// A scene and its views.
struct SimulatedScene {
  SceneKind kind = SceneKind::pile;
  SensorKind sensor = SensorKind::structured_light;
  std::vector<SimulatedFrame> frames;  ///< All shots of a view, then those of the next.
};

/// The objects, and the distractors, tables, bin and room about them, made ready for rendering
/// once. Immutable.
class Stage {
 public:
  /// `look_alikes` lie about as further distractors.
  explicit Stage(std::vector<SimulatedObject> objects, int num_threads = 0,
                 std::vector<SimulatedObject> look_alikes = {});

  const std::vector<SimulatedObject>& objects() const { return objects_; }
  /// The room, the bin, four tables, then the distractors.
  const std::vector<SimulatedObject>& scenery() const { return scenery_; }
  /// Of the objects, then of the scenery.
  const RayMeshes& meshes() const { return *meshes_; }
  /// The object or scenery of one of the meshes.
  const SimulatedObject& body(int mesh) const;

 private:
  std::vector<SimulatedObject> objects_, scenery_;
  std::unique_ptr<RayMeshes> meshes_;
};

/// One frame with its truth. The first posed meshes of the scene are the instances: instance i is
/// the object of index `objects[i]`.
SimulatedFrame capture(const SensorView& view, const std::vector<int>& objects,
                       const SensorOptions& options, std::uint64_t seed, int shot, int num_threads);

/// One scene. An ambiguous one needs an object with telltales. The same stage, options and seed
/// give the same scene for any number of threads.
SimulatedScene simulate_scene(const Stage& stage, const SceneOptions& options, std::uint64_t seed,
                              int num_threads = 0);

/// The seed of scene `index` of a set.
std::uint64_t scene_seed(std::uint64_t set_seed, int index);

/// The mask of one instance's visible pixels: 255 or 0, row-major.
std::vector<std::uint8_t> visible_mask(const SimulatedFrame& frame, int instance);

/// The pose of a camera that looks at `target` from `distance` metres. It is `elevation` radians
/// above the horizon, turned by `azimuth` about the vertical and by `roll` about its own axis.
Pose camera_looking_at(const Eigen::Vector3d& target, double distance, double elevation,
                       double azimuth, double roll);

}  // namespace bpa::sim
