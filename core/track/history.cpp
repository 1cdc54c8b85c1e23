// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/history.hpp"

#include <algorithm>
#include <utility>

#include "core/track/observe.hpp"

namespace bpa::track {
namespace {

constexpr double kKept_s = 2.5;  // images
constexpr double kKeptEvery_s = 0.03;
constexpr int kCoarseStep_px = 8;  // between depths that are compared with another frame's

}  // namespace

void History::remember(std::shared_ptr<const Frame> frame, const Pose& frame_from_camera,
                       std::vector<TrackRecord> tracks) {
  const std::int64_t now = frame->stamp_ns;
  const auto older = [&](std::int64_t stamp, double than_s) {
    return seconds(now - stamp) > than_s;
  };
  std::erase_if(records_,
                [&](const FrameRecord& record) { return older(record.stamp_ns, kRemembered_s); });
  std::erase_if(kept_, [&](const KeptFrame& one) { return older(one.frame->stamp_ns, kKept_s); });
  records_.push_back(
      {now, frame_from_camera, std::move(tracks), sampled_depths(*frame, {}, kCoarseStep_px)});
  if (kept_.empty() || older(kept_.back().frame->stamp_ns, kKeptEvery_s)) {
    kept_.push_back({std::move(frame), frame_from_camera});
  }
}

void History::clear() {
  records_.clear();
  kept_.clear();
}

const FrameRecord* History::record_of(std::int64_t stamp_ns) const {
  const auto found = std::ranges::find(records_, stamp_ns, &FrameRecord::stamp_ns);
  return found == records_.end() ? nullptr : &*found;
}

std::span<const KeptFrame> History::kept_after(std::int64_t stamp_ns) const {
  const auto first = std::ranges::find_if(
      kept_, [&](const KeptFrame& one) { return one.frame->stamp_ns > stamp_ns; });
  return {first, kept_.end()};
}

}  // namespace bpa::track
