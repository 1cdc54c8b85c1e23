// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/newcomer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bpa::track {

Newcomer::Newcomer(Placement found, std::shared_ptr<const ObjectModel> model, std::uint64_t track,
                   const FrameRecord& then)
    : found_(std::move(found)),
      model_(std::move(model)),
      track_(track),
      stamp_ns_(then.stamp_ns),
      frame_from_camera_(then.frame_from_camera) {}

void Newcomer::begin() {
  Placement likeliest = found_;
  if (tried_ > 0) likeliest.camera_from_object = found_.alternatives[tried_ - 1].camera_from_object;
  tried_pose_ = likeliest.camera_from_object;
  const Placement in_frame = transformed(frame_from_camera_, likeliest);
  const UncertainPose start{in_frame.camera_from_object, in_frame.covariance};
  body_ = Body{.model = model_,
               .places = std::make_shared<FeaturePlaces>(*model_),
               .motion = MotionFilter(start),
               .last_seen = start.pose};
  body_->visible_fraction = found_.visible_fraction;
  at_ns_ = stamp_ns_;
}

void Newcomer::follow_to(const View& view, Body& body, std::int64_t from_ns) const {
  follow(view, 1e-9 * static_cast<double>(view.frame.stamp_ns - from_ns), body);
}

Newcomer::Progress Newcomer::step(const std::deque<KeptFrame>& since, const View& newest,
                                  int most) {
  const std::int64_t now = newest.frame.stamp_ns;
  if (!body_) {
    begin();
    if (now == stamp_ns_) return Progress::arrived;
    Body at_rest = *body_;
    follow_to(newest, at_rest, stamp_ns_);
    if (at_rest.sight == Sight::seen) {
      body_ = std::move(at_rest);
      return Progress::arrived;
    }
  }
  for (const KeptFrame& kept : since) {
    const std::int64_t stamp = kept.frame->stamp_ns;
    if (stamp <= at_ns_) continue;
    if (most-- == 0) return Progress::on_the_way;
    follow_to(
        {*kept.frame, newest.sensor, kept.frame_from_camera, newest.layers, newest.background},
        *body_, at_ns_);
    at_ns_ = stamp;
  }
  if (at_ns_ < now) follow_to(newest, *body_, at_ns_);
  if (body_->sight != Sight::absent) return Progress::arrived;
  body_.reset();
  return ++tried_ > found_.alternatives.size() ? Progress::gone : Progress::on_the_way;
}

Body Newcomer::take_body() {
  const Pose since = now_from_then();
  Body body = std::move(*body_);
  add_alternatives(found_, since, body);
  return body;
}

void add_alternatives(const Placement& found, const Pose& now_from_then, Body& body) {
  constexpr double kLeastWeight = 0.01;  // of the placement's own pose
  double own = 1;
  for (const PoseAlternative& other : found.alternatives) own -= other.weight;
  for (const PoseAlternative& other : found.alternatives) {
    add_mode(body, now_from_then * other.camera_from_object,
             std::log(other.weight / std::max(kLeastWeight, own)));
  }
}

}  // namespace bpa::track
