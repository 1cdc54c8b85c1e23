// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/convert.hpp"

#include <Eigen/Core>
#include <cstdio>

namespace bpa::cli {
namespace {

using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Axes = Eigen::Matrix<double, 4, 3>;  // an axis a column, one after the other in memory

Pose to_pose(const ObjectPose& pose) {
  const auto& [x, y, z, w] = pose.orientation;
  return {Eigen::Quaterniond(w, x, y, z), Eigen::Vector3d::Map(pose.position.data())};
}

OrientationUncertainty to_uncertainty(const OrientationSpread& spread) {
  return {Axes::Map(spread.axes[0].data()), Eigen::Vector3d::Map(spread.concentrations.data())};
}

Track to_track(const TrackedObject& object) {
  Track track;
  track.id = object.id;
  track.name = object.name;
  track.model = object.model;
  track.model_number = object.model_number;
  track.state = static_cast<TrackState>(object.state);  // of the same order
  track.probability = object.probability;
  track.frame_from_object = to_pose(object.frame_from_object);
  track.covariance = RowMajor6::Map(object.covariance.data());
  track.orientation = to_uncertainty(object.orientation_spread);
  track.velocity = Eigen::Vector3d::Map(object.velocity.data());
  track.angular_velocity = Eigen::Vector3d::Map(object.angular_velocity.data());
  track.visible_fraction = object.visible_fraction;
  track.age_s = object.age_s;
  track.unseen_s = object.unseen_s;
  track.held = object.held;
  track.weight = object.weight;
  for (const TrackedAlternative& other : object.alternatives) {
    track.alternatives.push_back({to_pose(other.frame_from_object), other.weight});
  }
  return track;
}

Placement to_placement(const Detection& detection) {
  Placement placement;
  placement.model_number = detection.model_number;
  placement.model = detection.model;
  placement.frame_from_object = to_pose(detection.camera_from_object);
  placement.covariance = RowMajor6::Map(detection.covariance.data());
  placement.orientation = to_uncertainty(detection.orientation_spread);
  placement.score = detection.score;
  placement.probability = detection.probability;
  placement.presence = detection.presence;
  placement.visible_fraction = detection.visible_fraction;
  for (const ScorePart& part : detection.score_parts) {
    placement.components.push_back({part.name, part.value});
  }
  for (const AlternativePose& other : detection.alternatives) {
    placement.alternatives.push_back({to_pose(other.camera_from_object), other.weight});
  }
  return placement;
}

}  // namespace

std::pair<int, int> scene_and_image(const std::string& frame_id) {
  int scene = 0, image = 0, length = 0;
  const int found = std::sscanf(frame_id.c_str(), "%d/%d%n", &scene, &image, &length);
  if (found != 2 || static_cast<std::size_t>(length) != frame_id.size()) return {0, 0};
  return {scene, image};
}

io::FrameResult to_frame_result(const DetectionSet& set) {
  io::FrameResult result;
  std::tie(result.scene_id, result.im_id) = scene_and_image(set.frame_id);
  result.seconds = 0.001 * set.total_ms;
  result.server = io::ServerAnswer{set.status, set.queue_position};
  result.stamp_ns = set.stamp_ns;
  result.frame_id = set.frame_id;
  result.total_milliseconds = set.total_ms;
  result.budget_exhausted = set.budget_exhausted;
  result.fused_frames = set.fused_frames;
  for (const MissedObjects& missed : set.missed) {
    result.missed.push_back({missed.model_name, missed.expected});
  }
  for (const StageTime& time : set.stage_times) {
    result.timings.push_back({time.stage, time.milliseconds});
  }
  for (const RankedInterpretation& ranked : set.interpretations) {
    result.interpretations.push_back({ranked.rank, ranked.score, ranked.probability, {}});
    for (const Detection& detection : ranked.detections) {
      result.interpretations.back().placements.push_back(to_placement(detection));
    }
  }
  return result;
}

io::TrackResult to_track_result(const TrackSet& set) {
  io::TrackResult result;
  std::tie(result.scene_id, result.im_id) = scene_and_image(set.camera_frame_id);
  result.stamp_ns = set.stamp_ns;
  result.frame_id = set.frame_id;
  result.camera_frame_id = set.camera_frame_id;
  result.in_fixed_frame = set.in_fixed_frame;
  result.frame_from_camera = to_pose(set.frame_from_camera);
  for (const TrackedObject& object : set.tracks) result.tracks.push_back(to_track(object));
  for (const auto& [id, name, reason] : set.ended) result.ended.push_back({id, name, reason});
  result.milliseconds = set.total_ms;
  return result;
}

ExpectedPose to_expected_pose(const PosePrior& prior) {
  ExpectedPose out;
  out.model = prior.model;
  out.weight = prior.weight;
  if (prior.position) {
    Eigen::Vector3d::Map(out.camera_from_object.position.data()) = prior.position->mean;
    RowMajor3::Map(out.position_covariance.data()) = prior.position->covariance;
  }
  const auto& [axes, concentrations] = prior.orientation;
  Axes::Map(out.orientation_spread.axes[0].data()) = axes;
  Eigen::Vector3d::Map(out.orientation_spread.concentrations.data()) = concentrations;
  // The mode m is at right angles to all three axes: I - A Aᵀ = m mᵀ. Without axes it does not
  // count.
  const Eigen::Matrix4d squares = Eigen::Matrix4d::Identity() - axes * axes.transpose();
  Eigen::Index longest;
  squares.diagonal().maxCoeff(&longest);
  const Eigen::Vector4d mode = squares.col(longest).normalized();  // w, x, y, z
  out.camera_from_object.orientation = {{mode[1], mode[2], mode[3], mode[0]}};
  return out;
}

}  // namespace bpa::cli
