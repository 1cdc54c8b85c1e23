// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/src/convert.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "core/base/concat.hpp"
#include "idl/wire/status.hpp"

namespace bpa::sdk {
namespace {

namespace msgs = wire::bpa_msgs;

constexpr std::int64_t kMinSide = 16;  // of a frame, pixels
constexpr std::int64_t kMaxSide = 8192;

OrientationSpread to_spread(const msgs::Bingham& message) {
  OrientationSpread spread;
  for (std::size_t i = 0; i < 12; ++i) spread.axes[i / 4][i % 4] = message.axes[i];
  spread.concentrations = message.concentrations;
  return spread;
}

std::array<double, 3> to_array(const wire::geometry_msgs::Vector3& v) { return {{v.x, v.y, v.z}}; }

TrackedObject to_tracked_object(const msgs::Track& message) {
  TrackedObject object;
  object.id = message.id;
  object.name = message.name;
  object.model = message.model;
  object.model_number = static_cast<int>(message.model_number);
  if (message.state <= msgs::Track::kLost) object.state = static_cast<TrackedState>(message.state);
  object.probability = message.probability;
  object.frame_from_object = to_pose(message.pose.pose);
  object.covariance = message.pose.covariance;
  object.orientation_spread = to_spread(message.orientation);
  object.velocity = to_array(message.velocity.linear);
  object.angular_velocity = to_array(message.velocity.angular);
  object.visible_fraction = message.visible_fraction;
  object.age_s = message.age_s;
  object.unseen_s = message.unseen_s;
  object.held = message.held;
  object.weight = message.weight;
  for (const auto& other : message.alternatives) {
    object.alternatives.push_back({to_pose(other.pose), other.weight});
  }
  return object;
}

Detection to_detection(const msgs::Placement& message) {
  Detection detection;
  detection.model = message.model;
  detection.model_number = static_cast<int>(message.model_number);
  detection.instance = static_cast<int>(message.instance);
  detection.camera_from_object = to_pose(message.pose.pose);
  detection.covariance = message.pose.covariance;
  detection.orientation_spread = to_spread(message.orientation);
  detection.score = message.score;
  detection.probability = message.probability;
  detection.presence = message.presence;
  detection.visible_fraction = message.visible_fraction;
  for (const auto& part : message.score_components) {
    detection.score_parts.push_back({part.name, part.value});
  }
  for (const auto& alternative : message.alternatives) {
    detection.alternatives.push_back({to_pose(alternative.pose), alternative.weight});
  }
  return detection;
}

std::array<double, 3> to_array(const wire::geometry_msgs::Point& p) { return {{p.x, p.y, p.z}}; }

std::vector<StageTime> to_stage_times(const std::vector<msgs::StageTiming>& timings) {
  std::vector<StageTime> times;
  for (const auto& timing : timings) times.push_back({timing.name, timing.duration_ms});
  return times;
}

/// A view or a vector of some bytes; empty without data.
template <class Bytes>
Bytes bytes(const void* data, std::size_t size) {
  const auto* first = static_cast<const std::uint8_t*>(data);
  if (first == nullptr) return {};
  if constexpr (std::is_same_v<Bytes, wire::ByteView>) {
    return {first, size};
  } else {
    return Bytes(first, first + size);
  }
}

template <class Bytes>
msgs::BasicRgbdFrame<Bytes> make_message(const FrameView& frame) {
  msgs::BasicRgbdFrame<Bytes> message;
  const std::size_t pixels =
      static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  message.header = {wire::builtin_interfaces::from_ns(frame.stamp_ns), frame.frame_id};
  message.width = static_cast<std::uint32_t>(frame.width);
  message.height = static_cast<std::uint32_t>(frame.height);
  if (frame.rgb != nullptr) message.color_encoding = "rgb8";
  message.color = bytes<Bytes>(frame.rgb, 3 * pixels);
  if (frame.depth_mm != nullptr) {
    message.depth_encoding = "16UC1";
    message.depth = bytes<Bytes>(frame.depth_mm, 2 * pixels);
  } else {
    message.depth_encoding = "32FC1";
    message.depth = bytes<Bytes>(frame.depth_m, 4 * pixels);
  }
  message.k = {{frame.fx, 0, frame.cx, 0, frame.fy, frame.cy, 0, 0, 1}};
  message.mask = bytes<Bytes>(frame.mask, pixels);
  message.roi.x_offset = static_cast<std::uint32_t>(std::max(0, frame.roi[0]));
  message.roi.y_offset = static_cast<std::uint32_t>(std::max(0, frame.roi[1]));
  message.roi.width = static_cast<std::uint32_t>(std::max(0, frame.roi[2]));
  message.roi.height = static_cast<std::uint32_t>(std::max(0, frame.roi[3]));
  return message;
}

msgs::PosePrior to_message(const ExpectedPose& prior) {
  msgs::PosePrior message;
  message.model = prior.model;
  message.pose = sdk::to_message(prior.camera_from_object);
  for (std::size_t i = 0; i < 12; ++i) {
    message.orientation.axes[i] = prior.orientation_spread.axes[i / 4][i % 4];
  }
  message.orientation.concentrations = prior.orientation_spread.concentrations;
  message.position_covariance = prior.position_covariance;
  message.weight = prior.weight;
  return message;
}

}  // namespace

ObjectPose to_pose(const wire::geometry_msgs::Pose& message) {
  const auto& p = message.position;
  const auto& q = message.orientation;
  return {{{p.x, p.y, p.z}}, {{q.x, q.y, q.z, q.w}}};
}

wire::geometry_msgs::Pose to_message(const ObjectPose& pose) {
  const auto& p = pose.position;
  const auto& q = pose.orientation;
  return {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}};
}

DetectionSet to_detections(const msgs::SceneInterpretations& message) {
  DetectionSet set;
  set.stamp_ns = to_ns(message.header.stamp);
  set.frame_id = message.header.frame_id;
  set.status = wire::to_status(message.status);
  for (const auto& interpretation : message.interpretations) {
    RankedInterpretation ranked{static_cast<int>(interpretation.rank),
                                interpretation.score,
                                interpretation.probability,
                                {}};
    for (const auto& placement : interpretation.placements) {
      ranked.detections.push_back(to_detection(placement));
    }
    set.interpretations.push_back(std::move(ranked));
  }
  set.stage_times = to_stage_times(message.stage_timings);
  set.total_ms = message.total_ms;
  set.budget_exhausted = message.budget_exhausted;
  set.fused_frames = static_cast<int>(message.fused_frames);
  for (const auto& missed : message.missed) {
    set.missed.push_back({missed.model_name, missed.expected});
  }
  set.models_searched = static_cast<int>(message.models_searched);
  set.seed = message.seed;
  return set;
}

TrackSet to_tracks(const msgs::Tracks& message) {
  TrackSet set;
  set.stamp_ns = to_ns(message.header.stamp);
  set.frame_id = message.header.frame_id;
  set.camera_frame_id = message.camera_frame_id;
  set.in_fixed_frame = message.in_fixed_frame;
  set.frame_from_camera = to_pose(message.camera);
  for (const msgs::Track& track : message.tracks) set.tracks.push_back(to_tracked_object(track));
  for (const auto& [id, name, reason] : message.ended) set.ended.push_back({id, name, reason});
  set.total_ms = message.total_ms;
  return set;
}

KnownModel to_model(const msgs::ModelInfo& message) {
  return {message.name,
          static_cast<int>(message.number),
          message.diameter,
          to_array(message.box_min),
          to_array(message.box_max),
          static_cast<int>(message.point_count),
          static_cast<int>(message.discrete_symmetries.size()),
          static_cast<int>(message.continuous_symmetries.size())};
}

ServerStatus to_server_status(const msgs::GetStatus_Response& message) {
  ServerStatus status;
  status.version = message.version;
  status.state = message.state == msgs::GetStatus_Response::kIdle     ? "idle"
                 : message.state == msgs::GetStatus_Response::kPaused ? "paused"
                                                                      : "running";
  status.uptime_s = message.uptime_s;
  status.frames_received = message.frames_received;
  status.frames_processed = message.frames_processed;
  status.frames_dropped = message.frames_dropped;
  status.frames_rejected = message.frames_rejected;
  status.requests_served = message.requests_served;
  status.requests_refused = message.requests_refused;
  status.queue_length = static_cast<int>(message.queue_length);
  status.queue_capacity = static_cast<int>(message.queue_capacity);
  status.model_count = static_cast<int>(message.model_count);
  status.library = message.library;
  status.memory_bytes = message.memory_bytes;
  status.stage_times = to_stage_times(message.stage_timings);
  for (const auto& detail : message.details) {
    status.details.emplace_back(detail.key, detail.value);
  }
  return status;
}

Result<AnnotatedImage> to_image(wire::sensor_msgs::Image&& message) {
  const std::size_t bytes = std::size_t{3} * message.width * message.height;
  if (message.encoding != "rgb8" || std::max(message.width, message.height) > kMaxSide ||
      message.data.size() != bytes) {
    return invalid_argument("an image whose pixels are not as the server sends them");
  }
  return AnnotatedImage{to_ns(message.header.stamp), message.header.frame_id,
                        static_cast<int>(message.width), static_cast<int>(message.height),
                        std::move(message.data)};
}

Status check(const FrameView& frame) {
  const auto fits = [](std::int64_t side) { return side >= kMinSide && side <= kMaxSide; };
  if (!fits(frame.width) || !fits(frame.height)) {
    return invalid_argument("frame is ", frame.width, "x", frame.height,
                            "; each side must be between ", kMinSide, " and ", kMaxSide);
  }
  if ((frame.depth_mm == nullptr) == (frame.depth_m == nullptr)) {
    return invalid_argument("frame has " + std::string(frame.depth_m ? "two depths" : "no depth") +
                            "; exactly one of depth_mm and depth_m must be set");
  }
  for (const int value : frame.roi) {
    if (value < 0) return invalid_argument("frame roi has a negative value; none may be");
  }
  return {};
}

Result<FrameView> to_view(const msgs::RgbdFrame& message) {
  FrameView view;
  view.width = static_cast<int>(std::min(message.width, 1U << 20U));
  view.height = static_cast<int>(std::min(message.height, 1U << 20U));
  const std::size_t pixels = std::size_t{message.width} * message.height;
  const bool millimetres = message.depth_encoding == "16UC1";
  const bool has_color = !message.color.empty();
  if ((!millimetres && message.depth_encoding != "32FC1") ||
      message.depth.size() != (millimetres ? 2 : 4) * pixels ||
      (has_color && (message.color_encoding != "rgb8" || message.color.size() != 3 * pixels)) ||
      (!message.mask.empty() && message.mask.size() != pixels)) {
    return invalid_argument("a frame whose pixels are not as the SDK sends them");
  }
  view.rgb = has_color ? message.color.data() : nullptr;
  // The bytes of a vector are aligned for any type.
  const void* depth = message.depth.data();
  view.depth_mm = millimetres ? static_cast<const std::uint16_t*>(depth) : nullptr;
  view.depth_m = millimetres ? nullptr : static_cast<const float*>(depth);
  view.mask = message.mask.empty() ? nullptr : message.mask.data();
  view.fx = message.k[0];
  view.cx = message.k[2];
  view.fy = message.k[4];
  view.cy = message.k[5];
  view.stamp_ns = to_ns(message.header.stamp);
  view.frame_id = message.header.frame_id;
  if (Status status = check(view); !status.ok()) return status;
  return view;
}

wire::bpa_msgs::RgbdFrameView to_message(const FrameView& frame) {
  return make_message<wire::ByteView>(frame);
}

wire::bpa_msgs::RgbdFrame to_owned_message(const FrameView& frame) {
  return make_message<std::vector<std::uint8_t>>(frame);
}

Result<std::vector<msgs::PosePrior>> to_messages(const std::vector<ExpectedPose>& priors) {
  std::vector<msgs::PosePrior> messages;
  for (const ExpectedPose& prior : priors) {
    if (!(prior.weight > 0 && prior.weight <= 1)) {
      return invalid_argument("priors[", messages.size(), "].weight is ",
                              std::to_string(prior.weight), "; it must be above 0 and at most 1");
    }
    messages.push_back(to_message(prior));
  }
  return messages;
}

}  // namespace bpa::sdk

namespace bpa {

const char* to_string(TrackedState state) {
  constexpr const char* kNames[] = {"tentative", "confirmed", "occluded", "lost"};
  return kNames[static_cast<std::size_t>(state)];
}

// A small turn by d about the camera's axes has the quaternion (d / 2, 1): the Gaussian exp(-d^2 /
// 2 sigma^2) is the Bingham with the concentration -2 / sigma^2 about (axis, 0) * orientation.
OrientationSpread spread_about(const std::array<double, 4>& orientation, double sigma_rad) {
  const auto [x, y, z, w] = orientation;
  OrientationSpread spread;
  spread.axes = {{{{-x, w, -z, y}}, {{-y, z, w, -x}}, {{-z, -y, x, w}}}};
  spread.concentrations.fill(-2 / (sigma_rad * sigma_rad));
  return spread;
}

ExpectedPose expected_pose(const std::string& model, const ObjectPose& camera_from_object,
                           double position_sigma_m, double sigma_rad, double weight) {
  ExpectedPose prior;
  prior.model = model;
  prior.camera_from_object = camera_from_object;
  for (std::size_t i = 0; i < 3; ++i) {
    prior.position_covariance[4 * i] = position_sigma_m * position_sigma_m;
  }
  prior.orientation_spread = spread_about(camera_from_object.orientation, sigma_rad);
  prior.weight = weight;
  return prior;
}

}  // namespace bpa
