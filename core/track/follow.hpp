// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/cloud/sensor_noise.hpp"
#include "core/model/object_model.hpp"
#include "core/observation/scene_features.hpp"
#include "core/result/track.hpp"
#include "core/score/feature_score.hpp"
#include "core/score/score_layer.hpp"
#include "core/track/motion_filter.hpp"

namespace bpa::track {

/// A frame and what tracks need of it. Keeps references.
struct ObservedFrame {
  const Frame& frame;
  const SceneFeatures& scene;  ///< observe() of the frame.
  Pose frame_from_camera;      ///< Of the tracks' frame of reference.
  const score::ScoreLayers& layers;

  Pose in_camera(const Pose& frame_from_object) const {
    return frame_from_camera.inverse() * frame_from_object;
  }
};

/// What a frame shows at a pose.
enum class Sight : std::uint8_t {
  seen,    ///< The object is there.
  hidden,  ///< It may be: nearer surface hides it, or the image ends there.
  absent,  ///< Another surface is seen there.
};

/// Another pose that the views so far explain as well.
struct Mode {
  Pose object_from_mode;  ///< From the object's axes at the pose to those at the other one.
  double log_weight = 0;  ///< Against 0, the pose's own.
};

/// One object and its motion.
struct Body {
  std::shared_ptr<const ObjectModel> model;
  std::shared_ptr<const score::FeaturePlaces> places;  ///< Of the model; scores ask for it.
  MotionFilter motion;
  std::vector<Mode> modes = {};
  Sight sight = Sight::seen;                  ///< In the last frame.
  double visible_fraction = 1;                ///< In the last frame.
  Pose last_seen = {};                        ///< Where it was seen last.
  int unseen = 0;                             ///< Frames in a row.
  int seen = 0;                               ///< Alignments in a row that found it.
  std::optional<MotionFilter> before = {};    ///< Of the last of them, before it was corrected.
  std::optional<double> usual_log_odds = {};  ///< Of the poses where most of it was in sight.
  int doubts = 0;                             ///< Frames in a row with log odds far below these.
  Pose compared_from = {};  ///< object_from_camera when the modes were last compared.
  int compared = 0;         ///< Times that the modes were compared.
  int frames_since_compared = 0;
  std::size_t to_compare = 0;      ///< Modes that this comparison has left, the first ones.
  std::vector<float> around = {};  ///< Depths of the surroundings when it was last aligned.
  RegionOfInterest around_region = {};
};

/// Moves the body on by `seconds`, to where the next frame should show it.
void predict(double seconds, Body& body);

/// Whether the frame shows what it showed around a resting body when that was last aligned.
bool looks_unchanged(const Frame& frame, const SensorNoise& noise, const Pose& frame_from_camera,
                     const Body& body);

/// Aligns a predicted body with the frame, judges what is seen there, and corrects its motion.
void correct(const ObservedFrame& observed, Body& body);

/// The surface that the last alignment found is of another object: this one is behind it.
void take_back(Body& body);

/// Where the modes of a mixture differ in what a frame shows, their weights follow. Near-symmetric
/// turns of the model are modes too. Drops modes that have become unlikely. One that has become
/// clearly likelier than the pose becomes the pose.
void compare_modes(const ObservedFrame& observed, Body& body);

/// A search takes this pose, in the tracks' frame of reference, for right: its weight rises by
/// `says`, or those of all modes fall where it is the body's own. It is added with `log_weight` if
/// it is new. A mode that has become clearly likelier than the pose becomes the pose.
void favour_mode(Body& body, const Pose& frame_from_object, double log_weight, double says);

/// Adds another pose, in the tracks' frame of reference, unless the body has it.
void add_mode(Body& body, const Pose& frame_from_object, double log_weight);

}  // namespace bpa::track
