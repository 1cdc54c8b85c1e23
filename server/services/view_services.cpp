// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <utility>

#include "core/base/concat.hpp"
#include "core/base/guarded.hpp"
#include "ros/frames.hpp"
#include "server/convert/parts.hpp"
#include "server/services/services.hpp"

namespace bpa::server {
namespace {

namespace msgs = wire::bpa_msgs;
using ViewsReply = Reply<msgs::DetectViews>;

/// A frame of the largest sides has 604 MB.
constexpr std::size_t kMaxViewsRequest = std::size_t{640} << 20U;

/// What one request asks, decoded.
struct ViewsAsked {
  std::vector<View> views;
  DetectRequest search;
  std::string fixed_frame;
};

Pose pose_of(const wire::geometry_msgs::Pose& message) {
  const auto& q = message.orientation;
  const auto& p = message.position;
  return {Eigen::Quaterniond(q.w, q.x, q.y, q.z), {p.x, p.y, p.z}};
}

Status check(const msgs::DetectViews_Request& request, const std::string& fixed_frame) {
  if (request.frames.empty() || request.frames.size() > kMostViews) {
    return invalid_argument("frames has ", request.frames.size(), " entries; it must have 1 to ",
                            kMostViews);
  }
  if (!request.scene_from_camera.empty() &&
      request.scene_from_camera.size() != request.frames.size()) {
    return invalid_argument("scene_from_camera has ", request.scene_from_camera.size(),
                            " entries; it must have one for each of the ", request.frames.size(),
                            " frames, or none");
  }
  if (fixed_frame.empty()) {
    return invalid_argument(
        "fixed_frame is empty; name the frame of the results, or set tracking.fixed_frame");
  }
  return {};
}

/// Where the camera of frame `k` was.
Result<Pose> camera_of(const msgs::DetectViews_Request& request, std::size_t k,
                       const ViewsAsked& asked, const Frame& frame, const FindCamera& camera) {
  if (!request.scene_from_camera.empty()) {
    const Pose pose = pose_of(request.scene_from_camera[k]);
    if (is_valid(pose)) return pose;
    return invalid_argument("scene_from_camera[", k, "] is no rigid motion: its numbers must be ",
                            "finite and its quaternion of unit length");
  }
  Result<Pose> pose = camera(asked.fixed_frame, frame.frame_id, frame.stamp_ns);
  if (pose.ok()) return pose;
  return Status(pose.status().code,
                concat("frames[", k, "]: ", pose.status().message,
                       "; give scene_from_camera, or set tracking.fixed_frame for TF"));
}

Result<ViewsAsked> decode(msgs::DetectViews_Request& request, const ServerOptions& options,
                          const FindCamera& camera) {
  ViewsAsked asked;
  asked.fixed_frame =
      request.fixed_frame.empty() ? options.tracking.fixed_frame : request.fixed_frame;
  if (Status status = check(request, asked.fixed_frame); !status.ok()) return status;
  Result<DetectRequest> search = search_of(request, options.detection);
  if (!search.ok()) return search.status();
  asked.search = *std::move(search);
  for (std::size_t k = 0; k < request.frames.size(); ++k) {
    Result<std::vector<PosePrior>> priors = ros::priors_from_messages(request.frames[k].priors);
    if (!priors.ok()) return priors.status();
    ros::DecodedFrame frame = ros::frame_from_message(std::move(request.frames[k]));
    if (!frame.ok()) {
      return Status(frame.status().code, concat("frames[", k, "]: ", frame.status().message));
    }
    const Result<Pose> pose = camera_of(request, k, asked, *frame, camera);
    if (!pose.ok()) return pose.status();
    asked.views.push_back({std::move(*frame), *pose, std::move(*priors)});
  }
  return asked;
}

void answer(const ServiceContext& context, const FindCamera& camera,
            msgs::DetectViews_Request& request, const ViewsReply& reply) {
  Result<ViewsAsked> asked = decode(request, *context.settings.get(), camera);
  if (!asked.ok()) return reply.refuse(asked.status());
  Result<ViewsResult> found = context.recognition->detect_views(asked->views, asked->search);
  if (!found.ok()) return reply.refuse(found.status());
  for (const std::string& warning : found->warnings) log(reply.log(), LogLevel::warning, warning);
  const auto& named = asked->search.models;
  const auto models = named.empty() ? context.recognition->models().size() : named.size();
  msgs::DetectViews_Response response = reply.refusal({});
  response.success = true;
  response.result = interpretations_message(
      found->scene,
      {found->scene.stamp_ns, asked->fixed_frame, static_cast<int>(models), asked->search.seed});
  for (const Pose& pose : found->scene_from_camera) {
    response.scene_from_camera.push_back(pose_message(pose));
  }
  response.warnings = std::move(found->warnings);
  reply.send(response);
}

}  // namespace

void add_detect_views(const ServiceContext& context, FindCamera camera, ServiceSet& services) {
  services.add<msgs::DetectViews>(
      "detect_views",
      [context, camera = std::move(camera)](msgs::DetectViews_Request&& request,
                                            const ViewsReply& reply) {
        const auto own = std::make_shared<msgs::DetectViews_Request>(std::move(request));
        const auto work = [context, camera, own, reply] {
          reply.guard([&] { answer(context, camera, *own, reply); });
        };
        const auto refuse = [reply](const Status& status) { reply.refuse(status); };
        context.queue.run_later(reply.client(), {work, refuse});
      },
      kMaxViewsRequest);
}

}  // namespace bpa::server
