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
  BPA_OPTION(double, seconds, 20, (0.1, 60), "Length of a sequence.");
  BPA_OPTION(double, rate, 30, (1, 240), "Frames per second.");
  BPA_OPTION(double, drop, 0.03, (0, 0.9), "Share of frames that are missing; never the first.");
  BPA_OPTION(int, min_objects, 8, (1, 40), "Fewest objects.");
  BPA_OPTION(int, max_objects, 8, (1, 40), "Most objects.");
  BPA_OPTION(int, max_distractors, 2, (0, 12), "Most distractors, which stand.");
  BPA_OPTION(double, camera_speed, 0.5, (0, 2), "Largest speed of the camera, m/s; 0 = it stands.");
  BPA_OPTION(double, camera_turn_deg, 90, (0, 360),
             "Largest turn rate of the camera, degrees/s; 0 = it stands.");
  BPA_OPTION(double, object_speed, 0.5, (0.01, 2), "Largest speed of an object's origin, m/s.");
  BPA_OPTION(double, object_turn_deg, 90, (1, 360), "Largest turn rate of an object, degrees/s.");
  BPA_OPTION(double, max_occlusion, 1, (0.2, 10),
             "Longest time that an arm hides an object, seconds.");
  BPA_OPTION(double, min_distance, 0.7, (0.5, 4), "Camera to the middle of the table, metres.");
  BPA_OPTION(double, max_distance, 1.1, (0.5, 4), "Camera to the middle of the table, metres.");
  BPA_OPTION(double, min_elevation_deg, 30, (15, 85), "Camera above the table, degrees.");
  BPA_OPTION(double, max_elevation_deg, 60, (15, 85), "Camera above the table, degrees.");
  Camera camera{640, 480, 525, 525, 319.5, 239.5};  ///< Of the colour image and the frame.
  BPA_INLINE_GROUP(SensorOptions, sensor);
  BPA_OPTION(bool, mixed_sensors, false, (0, 1),
             "Each sequence takes one of the three kinds of sensors by its seed.");
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
