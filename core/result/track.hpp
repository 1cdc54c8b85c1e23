// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/result/placement.hpp"

namespace bpa {

enum class TrackState : std::uint8_t {
  tentative,  ///< Found once; the next frames and searches decide.
  confirmed,  ///< Followed in the newest frame.
  occluded,   ///< Hidden by nearer surface or outside of the image; its pose is predicted.
  lost,       ///< Not where it was expected, nor hidden; waits for a search to find it again.
};

/// "tentative", "confirmed", "occluded" or "lost".
std::string_view name_of(TrackState state);

/// One object, followed from frame to frame. Poses, velocities and covariances are about the axes
/// of TrackedFrame::frame_id.
struct Track {
  std::uint64_t id = 0;  ///< From 1; never used for another object in a run.
  std::string name;      ///< Unique among the tracks of a run; "MODEL_N" unless it was renamed.
  std::string model;     ///< The model's name.
  int model_number = 0;  ///< The model's number in its library.
  TrackState state = TrackState::tentative;
  double probability = 0;  ///< That the object is there, in [0, 1].
  Pose frame_from_object;  ///< Metres.
  /// Covariance of (x, y, z, rotation about x, y, z), metres and radians, as Placement's.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  OrientationUncertainty orientation = {};             ///< Of the pose; the alternatives are apart.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< Of the origin, m/s.
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< rad/s.
  double visible_fraction = 0;  ///< Of the surface that faces the camera, in the newest frame.
  double age_s = 0;             ///< Since its first frame.
  double unseen_s = 0;          ///< Since it was last seen.
  bool held = false;            ///< Kept however long it is not seen, because a user asked for it.
  double weight = 1;            ///< Of the pose against its alternatives.
  std::vector<PoseAlternative> alternatives = {};  ///< By falling weight; empty: none is left.
};

/// A track that is no more.
struct EndedTrack {
  std::uint64_t id = 0;
  std::string name;
  std::string reason;  ///< For people: "not seen for 5 s".
};

/// All tracks after one frame.
struct TrackedFrame {
  std::int64_t stamp_ns = 0;    ///< Exposure time of the frame, UTC.
  std::string frame_id;         ///< Of the poses: the fixed frame, or the camera's optical frame.
  std::string camera_frame_id;  ///< The optical frame of the camera.
  bool in_fixed_frame = false;  ///< Whether the camera's motion is known.
  Pose frame_from_camera;       ///< The identity without a fixed frame.
  std::vector<Track> tracks = {};      ///< By id. What is tentative or lost is among them.
  std::vector<EndedTrack> ended = {};  ///< In this frame.
  double milliseconds = 0;             ///< That following took.
};

}  // namespace bpa
