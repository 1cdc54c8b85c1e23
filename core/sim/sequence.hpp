// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/status.hpp"
#include "core/sim/scenes.hpp"

// Sequences of frames in which the camera, objects and a person's arm move. First a sequence is
// planned: what happens when, and all poses of all frames. Then each frame is captured by itself.

namespace bpa::sim {

/// What happens in a sequence.
enum class SequenceKind {
  mixed,          ///< Pushes, picks and occlusions in turn; in a third of them twins pass too.
  standing,       ///< Nothing moves, not even the camera.
  moving_camera,  ///< Only the camera moves. In all kinds below it moves too.
  pushed,         ///< A fist pushes objects over the table.
  picked,         ///< A hand lifts objects and puts them down elsewhere.
  occluded,       ///< An arm passes between camera and objects.
  twins,          ///< Two objects of one model pass each other.
  handle,         ///< An object that shows no telltale is turned until it does.
};

inline constexpr std::array kSequenceKinds{SequenceKind::mixed,         SequenceKind::standing,
                                           SequenceKind::moving_camera, SequenceKind::pushed,
                                           SequenceKind::picked,        SequenceKind::occluded,
                                           SequenceKind::twins,         SequenceKind::handle};

/// The name on command lines.
std::string_view name_of(SequenceKind kind);
/// Nothing for another name.
std::optional<SequenceKind> sequence_kind(std::string_view name);

/// The ranges that sequences are drawn from.
struct SequenceOptions {
  SequenceKind kind = SequenceKind::mixed;
  double seconds = 20;
  double rate = 30;
  double drop = 0.03;
  int min_objects = 8;
  int max_objects = 8;
  int max_distractors = 2;
  double camera_speed = 0.5;
  double camera_turn_deg = 90;
  double object_speed = 0.5;
  double object_turn_deg = 90;
  double max_occlusion = 1;
  double min_distance = 0.7;
  double max_distance = 1.1;
  double min_elevation_deg = 30;
  double max_elevation_deg = 60;
  Camera camera{640, 480, 525, 525, 319.5, 239.5};  ///< Of the colour image and the frame.
  SensorOptions sensor;
  bool mixed_sensors = false;

  void visit_fields(auto&& visit) {
    visit("seconds", seconds, {0.1, 60, "Length of a sequence."});
    visit("rate", rate, {1, 240, "Frames per second."});
    visit("drop", drop, {0, 0.9, "Share of frames that are missing; never the first."});
    visit("min_objects", min_objects, {1, 40, "Fewest objects."});
    visit("max_objects", max_objects, {1, 40, "Most objects."});
    visit("max_distractors", max_distractors, {0, 12, "Most distractors, which stand."});
    visit("camera_speed", camera_speed, {0, 2, "Largest speed of the camera, m/s; 0 = it stands."});
    visit("camera_turn_deg", camera_turn_deg,
          {0, 360, "Largest turn rate of the camera, degrees/s; 0 = it stands."});
    visit("object_speed", object_speed, {0.01, 2, "Largest speed of an object's origin, m/s."});
    visit("object_turn_deg", object_turn_deg,
          {1, 360, "Largest turn rate of an object, degrees/s."});
    visit("max_occlusion", max_occlusion,
          {0.2, 10, "Longest time that an arm hides an object, seconds."});
    visit("min_distance", min_distance, {0.5, 4, "Camera to the middle of the table, metres."});
    visit("max_distance", max_distance, {0.5, 4, "Camera to the middle of the table, metres."});
    visit("min_elevation_deg", min_elevation_deg, {15, 85, "Camera above the table, degrees."});
    visit("max_elevation_deg", max_elevation_deg, {15, 85, "Camera above the table, degrees."});
    sensor.visit_fields(visit);
    visit("mixed_sensors", mixed_sensors,
          {0, 1, "Each sequence takes one of the three kinds of sensors by its seed."});
  }
  void visit_groups(auto&& visit) { sensor.visit_groups(visit); }
};

/// One event.
struct SequenceEvent {
  SequenceKind kind = SequenceKind::pushed;  ///< pushed, picked, occluded, twins or handle.
  int instance = 0;                          ///< The object it happens to; of twins, the first.
  double start = 0, end = 0;                 ///< Seconds; of its motion, or of the arm's passage.
};

/// Where everything is in one frame.
struct SequenceFrame {
  std::int64_t stamp_ns = 0;  ///< From the sequence's start.
  bool dropped = false;
  Pose world_from_camera;         ///< The table is z = 0, z up.
  std::vector<PosedMesh> bodies;  ///< First the instances, in the order of Sequence::objects.
};

/// All that happens, before any image of it.
struct Sequence {
  SequenceKind kind = SequenceKind::mixed;
  SensorOptions sensor;
  Camera camera;
  std::uint64_t seed = 0;
  std::vector<int> objects;           ///< Of each instance, its index in the stage's objects.
  Shading shading;                    ///< Without materials.
  std::vector<SequenceEvent> events;  ///< By start.
  std::vector<SequenceFrame> frames;  ///< Also those that are dropped.
};

/// A stage whose look-alikes are make_arms(), as sequences need it.
Stage sequence_stage(std::vector<SimulatedObject> objects, int num_threads = 0);

/// Draws a sequence. An event that finds no room is left out. Fails with invalid_argument where the
/// options are wrong, or the kind is handle and no object has telltales. Deterministic.
Result<Sequence> plan_sequence(const Stage& stage, const SequenceOptions& options,
                               std::uint64_t seed);

/// One frame with its truth; frames may be captured in any order and by many threads.
SimulatedFrame capture_frame(const Stage& stage, const Sequence& sequence, int frame,
                             int num_threads = 1);

}  // namespace bpa::sim
