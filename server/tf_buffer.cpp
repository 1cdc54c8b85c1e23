// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tf_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "core/base/concat.hpp"
#include "idl/wire/time.hpp"

namespace bpa::server {
namespace {

// As tf2 does it (BufferCore::setTransform).
constexpr double kQuaternionTolerance = 0.01;

std::string without_slash(const std::string& name) {
  return name.starts_with('/') ? name.substr(1) : name;
}

bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= TfBuffer::kMaxNameLength;
}

/// Nothing for numbers that are no rigid transform.
std::optional<Pose> pose_of(const wire::geometry_msgs::Transform& message) {
  const auto& t = message.translation;
  const auto& q = message.rotation;
  Pose pose{Eigen::Quaterniond(q.w, q.x, q.y, q.z), {t.x, t.y, t.z}};
  const double norm = pose.rotation.norm();
  if (!pose.translation.allFinite() || !(std::abs(norm - 1) <= kQuaternionTolerance)) {
    return std::nullopt;
  }
  pose.rotation.normalize();
  return pose;
}

Pose interpolated(const Pose& a, const Pose& b, double part) {
  return {a.rotation.slerp(part, b.rotation), (1 - part) * a.translation + part * b.translation};
}

std::string in_seconds(std::int64_t ns) { return fixed(1e-9 * static_cast<double>(ns), 3) + " s"; }

}  // namespace

void TfBuffer::set_keep(double keep_s) {
  const std::lock_guard<std::mutex> lock(mutex_);
  keep_ns_ = static_cast<std::int64_t>(keep_s * 1e9);
}

void TfBuffer::add(const wire::geometry_msgs::TransformStamped& message, bool is_static) {
  const std::string child = without_slash(message.child_frame_id);
  const std::string parent = without_slash(message.header.frame_id);
  const std::optional<Pose> pose = pose_of(message.transform);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!pose || !is_name(child) || !is_name(parent)) {
    ++counts_.bad;
    return;
  }
  if (makes_loop(child, parent)) {
    ++counts_.loops;
    return;
  }
  if (frames_.size() >= kMaxFrames && frames_.count(child) == 0) {
    ++counts_.full;
    return;
  }
  ++counts_.taken;
  History& history = frames_[child];
  Sample sample{to_ns(message.header.stamp), parent, *pose};
  auto& samples = history.samples;
  if (is_static || history.is_static != is_static) samples.clear();
  history.is_static = is_static;
  if (!samples.empty() && sample.stamp_ns < samples.back().stamp_ns - keep_ns_) {
    ++counts_.restarts;
    samples.clear();
  }
  const auto place = std::ranges::lower_bound(samples, sample.stamp_ns, {}, &Sample::stamp_ns);
  if (place != samples.end() && place->stamp_ns == sample.stamp_ns) {
    *place = std::move(sample);
  } else {
    samples.insert(place, std::move(sample));
  }
  while (samples.size() > kMaxSamples ||
         samples.front().stamp_ns < samples.back().stamp_ns - keep_ns_) {
    samples.pop_front();
  }
  changed_.notify_all();
}

/// By the newest parents.
bool TfBuffer::makes_loop(const std::string& child, const std::string& parent) const {
  std::string frame = parent;
  for (std::size_t i = 0; i <= frames_.size(); ++i) {
    if (frame == child) return true;
    const auto above = frames_.find(frame);
    if (above == frames_.end()) return false;
    frame = above->second.samples.back().parent;
  }
  return true;
}

Result<TfBuffer::Sample> TfBuffer::at(const std::string& child, const History& history,
                                      std::int64_t stamp_ns) {
  const auto& samples = history.samples;
  if (history.is_static) return samples.front();
  const auto after = std::ranges::lower_bound(samples, stamp_ns, {}, &Sample::stamp_ns);
  if (after == samples.end()) {
    return unavailable("the last transform of ", child, " is ",
                       in_seconds(stamp_ns - samples.back().stamp_ns), " older than the frame");
  }
  if (after->stamp_ns == stamp_ns) return *after;
  if (after == samples.begin()) {
    return unavailable("the first transform of ", child, " is ",
                       in_seconds(after->stamp_ns - stamp_ns), " newer than the frame");
  }
  const Sample& before = *std::prev(after);
  if (before.parent != after->parent) return before;  // the parent changed in between
  const double part = static_cast<double>(stamp_ns - before.stamp_ns) /
                      static_cast<double>(after->stamp_ns - before.stamp_ns);
  return Sample{stamp_ns, before.parent,
                interpolated(before.parent_from_child, after->parent_from_child, part)};
}

TfBuffer::Chain TfBuffer::chain(const std::string& frame, std::int64_t stamp_ns) const {
  Chain chain{{{frame, Pose()}}, {}};
  for (std::size_t i = 0; i <= frames_.size(); ++i) {
    const auto& [name, name_from_frame] = chain.ancestors.back();
    const auto history = frames_.find(name);
    if (history == frames_.end()) return chain;
    Result<Sample> sample = at(name, history->second, stamp_ns);
    if (!sample.ok()) {
      chain.end = sample.status();
      return chain;
    }
    chain.ancestors.emplace_back(sample->parent, sample->parent_from_child * name_from_frame);
  }
  chain.end = unavailable("the parents of ", frame, " at the frame's stamp form a loop");
  return chain;
}

Result<Pose> TfBuffer::find(const std::string& target, const std::string& source,
                            std::int64_t stamp_ns) const {
  const Chain above_source = chain(source, stamp_ns);
  const Chain above_target = chain(target, stamp_ns);
  for (const auto& [name, name_from_source] : above_source.ancestors) {
    for (const auto& [other, other_from_target] : above_target.ancestors) {
      if (name == other) return other_from_target.inverse() * name_from_source;
    }
  }
  for (const Chain* chain : {&above_source, &above_target}) {
    if (!chain->end.ok()) return chain->end;
  }
  return not_found("no transforms connect ", source, " with ", target);
}

Result<Pose> TfBuffer::lookup(const std::string& target, const std::string& source,
                              std::int64_t stamp_ns) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return find(without_slash(target), without_slash(source), stamp_ns);
}

Result<Pose> TfBuffer::wait_for(const std::string& target, const std::string& source,
                                std::int64_t stamp_ns, std::chrono::nanoseconds timeout,
                                const std::stop_token& stop) const {
  const std::string above = without_slash(target), below = without_slash(source);
  std::unique_lock<std::mutex> lock(mutex_);
  Result<Pose> found = find(above, below, stamp_ns);
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  changed_.wait_until(lock, stop, deadline, [&] {
    if (!found.ok()) found = find(above, below, stamp_ns);
    return found.ok();
  });
  return found;
}

bool TfBuffer::knows(const std::string& frame) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::string name = without_slash(frame);
  if (frames_.count(name) > 0) return true;
  return std::ranges::any_of(
      frames_, [&](const auto& entry) { return entry.second.samples.back().parent == name; });
}

TfCounts TfBuffer::counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return counts_;
}

std::size_t TfBuffer::frames() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return frames_.size();
}

}  // namespace bpa::server
