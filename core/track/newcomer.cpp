// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/newcomer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/track/observe.hpp"

namespace bpa::track {
namespace {

constexpr double kPart_m = 0.15;  // around the object: what is looked at of a frame. By hand.

void follow_to(const ObservedFrame& observed, std::int64_t from_ns, Body& body) {
  predict(seconds(observed.frame.stamp_ns - from_ns), body);
  correct(observed, body);
}

// `newest` is another frame: sensor, background and layers are the same.
void follow_through(const KeptFrame& kept, const ObservedFrame& newest, std::int64_t from_ns,
                    Body& body) {
  const Frame& frame = *kept.frame;
  predict(seconds(frame.stamp_ns - from_ns), body);
  const Pose camera_from_newest = kept.frame_from_camera.inverse() * newest.frame_from_camera;
  std::vector<Plane> background;
  for (const Plane& plane : newest.scene.planes) {
    background.push_back(transformed(camera_from_newest, plane));
  }
  const Pose camera_from_object = kept.frame_from_camera.inverse() * body.motion.pose();
  const auto part = surroundings(frame, *body.model, camera_from_object, kPart_m);
  const SceneFeatures scene =
      part ? observe_part(frame, *part, newest.scene.map.sensor, background) : SceneFeatures();
  correct({frame, scene, kept.frame_from_camera, newest.layers}, body);
}

}  // namespace

Newcomer::Newcomer(Placement found, std::shared_ptr<const ObjectModel> model, std::uint64_t track,
                   const FrameRecord& then)
    : found_(std::move(found)),
      model_(std::move(model)),
      track_(track),
      stamp_ns_(then.stamp_ns),
      frame_from_camera_(then.frame_from_camera),
      at_ns_(then.stamp_ns) {}

void Newcomer::begin() {
  Placement likeliest = found_;
  if (tried_ > 0) likeliest.frame_from_object = found_.alternatives[tried_ - 1].frame_from_object;
  tried_pose_ = likeliest.frame_from_object;
  const Placement in_frame = transformed(frame_from_camera_, likeliest);
  const UncertainPose start{in_frame.frame_from_object, in_frame.covariance};
  body_ = Body{.model = model_,
               .places = std::make_shared<score::FeaturePlaces>(*model_),
               .motion = MotionFilter(start),
               .last_seen = start.pose};
  body_->visible_fraction = found_.visible_fraction;
  at_ns_ = stamp_ns_;
}

Newcomer::Progress Newcomer::step(std::span<const KeptFrame> since, const ObservedFrame& newest,
                                  std::size_t most) {
  const std::int64_t now = newest.frame.stamp_ns;
  if (!body_) {
    begin();
    if (now == stamp_ns_) return Progress::arrived;
    Body at_rest = *body_;
    follow_to(newest, stamp_ns_, at_rest);
    if (at_rest.sight == Sight::seen) {
      body_ = std::move(at_rest);
      return Progress::arrived;
    }
  }
  for (const KeptFrame& kept : since) {
    if (kept.frame->stamp_ns <= at_ns_) continue;
    if (most-- == 0) return Progress::on_the_way;
    follow_through(kept, newest, at_ns_, *body_);
    at_ns_ = kept.frame->stamp_ns;
  }
  follow_to(newest, at_ns_, *body_);
  if (body_->sight != Sight::absent) return Progress::arrived;
  body_.reset();
  at_ns_ = stamp_ns_;
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
  const double own = std::max(kLeastWeight, own_weight(found));
  for (const PoseAlternative& other : found.alternatives) {
    add_mode(body, now_from_then * other.frame_from_object, std::log(other.weight / own));
  }
}

}  // namespace bpa::track
