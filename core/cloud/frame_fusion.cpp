// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/frame_fusion.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/cloud/surface_map.hpp"

namespace bpa {
namespace {

bool agree(float depth, float median) {
  return std::abs(depth - median) <= kFusionAgreement * depth_noise(median);
}

std::string changed(const char* field, const auto& from, const auto& to) {
  return concat(field, " changed from ", from, " to ", to);
}

struct MovedPixels {
  std::size_t compared = 0;
  std::size_t moved = 0;
};

/// Combines pixel i of all frames, the last of which is the newest. `scratch` has room for them.
float fuse_pixel(const std::deque<std::vector<float>>& depths, std::size_t i,
                 std::vector<float>& scratch, MovedPixels& count) {
  const float newest = depths.back()[i];
  scratch.clear();
  for (const std::vector<float>& depth : depths) {
    if (depth[i] > 0) scratch.push_back(depth[i]);
  }
  const std::size_t found = scratch.size();
  if (found == 0) return 0;
  if (newest > 0 && found == 1) return newest;
  const AgreedDepth agreed = agreed_depth(scratch);
  const std::size_t agreeing = agreed.agreeing;
  if (newest <= 0) {
    return 2 * found >= depths.size() && 2 * agreeing > found ? agreed.mean : 0;
  }
  const bool among_them = agree(newest, agreed.median);
  ++count.compared;
  count.moved += !among_them || 2 * (agreeing - 1) < found - 1;
  return among_them ? agreed.mean : newest;
}

}  // namespace

AgreedDepth agreed_depth(std::span<float> depths) {
  const auto middle = depths.begin() + (depths.size() - 1) / 2;
  std::nth_element(depths.begin(), middle, depths.end());
  AgreedDepth out;
  out.median = *middle;
  // As differences from the median, so that equal depths have that depth as their mean.
  double sum = 0;
  for (const float depth : depths) {
    if (!agree(depth, out.median)) continue;
    sum += static_cast<double>(depth) - static_cast<double>(out.median);
    ++out.agreeing;
  }
  out.mean = static_cast<float>(static_cast<double>(out.median) + sum / out.agreeing);
  return out;
}

void FrameFusion::set_max_frames(int max_frames) {
  max_frames_ = std::max(1, max_frames);
  const std::size_t kept = max_frames_ == 1 ? 0 : max_frames_;
  while (depths_.size() > kept) depths_.pop_front();
}

std::string FrameFusion::change_of(const Frame& frame) const {
  const Camera &was = camera_, &now = frame.camera;
  if (now.width != was.width) return changed("camera.width", was.width, now.width);
  if (now.height != was.height) return changed("camera.height", was.height, now.height);
  const std::tuple<const char*, double, double> intrinsics[] = {{"camera.fx", was.fx, now.fx},
                                                                {"camera.fy", was.fy, now.fy},
                                                                {"camera.cx", was.cx, now.cx},
                                                                {"camera.cy", was.cy, now.cy}};
  for (const auto& [field, from, to] : intrinsics) {
    if (std::abs(to - from) > kSameCamera) return changed(field, from, to);
  }
  if (frame.frame_id == frame_id_) return {};
  return changed("frame_id", "\"" + frame_id_ + "\"", "\"" + frame.frame_id + "\"");
}

std::string FrameFusion::hold(const Frame& frame) {
  const std::string restart = depths_.empty() ? "" : change_of(frame);
  if (!restart.empty()) depths_.clear();
  camera_ = frame.camera;
  frame_id_ = frame.frame_id;
  if (max_frames_ == 1) return restart;
  if (depths_.size() == max_frames_) depths_.pop_front();
  depths_.push_back(frame.depth);
  return restart;
}

FusedFrame FrameFusion::add(Frame frame, int num_threads) {
  FusedFrame out;
  out.restart = hold(frame);
  out.frame = std::move(frame);
  if (depths_.size() < 2) return out;

  constexpr int kRow = 4096;  // pixels of a piece
  const std::size_t size = out.frame.depth.size();
  const std::size_t pieces = (size + kRow - 1) / kRow;
  std::vector<float> fused(size);
  std::vector<MovedPixels> counts(pieces);
  parallel_for(pieces, num_threads, [&](std::size_t p) {
    std::vector<float> scratch;
    for (std::size_t i = p * kRow; i < std::min(size, (p + 1) * kRow); ++i) {
      fused[i] = fuse_pixel(depths_, i, scratch, counts[p]);
    }
  });
  MovedPixels all;
  for (const MovedPixels& count : counts) {
    all.compared += count.compared;
    all.moved += count.moved;
  }
  const double share =
      static_cast<double>(all.moved) / std::max(1.0, static_cast<double>(all.compared));
  if (share > kMostMoved) {
    out.restart = std::to_string(std::lround(100 * share)) + " % of the depths changed";
    depths_.erase(depths_.begin(), depths_.end() - 1);
    return out;
  }
  out.frame.depth = std::move(fused);
  out.frame.fused = static_cast<int>(depths_.size());
  return out;
}

}  // namespace bpa
