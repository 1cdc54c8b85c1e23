// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/pose_check.hpp"

#include <algorithm>

#include "core/score/projected_block.hpp"

namespace bpa::score {
namespace {

// Facing points after which a hopeless pose is rejected. Most poses are rejected at the first look.
constexpr int kFirstLook = 8;
constexpr int kLastLook = 24;

bool hopeless(const PoseCheck& check) {
  if (check.facing == kFirstLook) {
    return check.seen > 4 && (check.agreeing == 0 || 2 * check.free_space > check.seen);
  }
  return check.seen > 8 && (5 * check.free_space > 2 * check.seen ||  //
                            5 * check.agreeing < check.seen);
}

}  // namespace

PoseCheck check_pose(const CheckImage& image, const CheckPoints& model, const FastPose& pose,
                     const CheckCount& count, const CheckTolerance& tolerance) {
  PoseCheck check;
  const int size = static_cast<int>(model.points.size());
  const int few_after = std::min(count.points, size);
  const int most = std::min(count.most_points, size);
  int last = few_after;
  const auto depth = static_cast<float>(tolerance.depth_m);
  const auto free_depth = static_cast<float>(tolerance.free_depth_m);
  const float cosine_127 = 127 * static_cast<float>(tolerance.normal_cosine);
  ProjectedBlock block;
  for (int first = 0; first < last; first += kCheckBlock) {
    if (first >= few_after && check.seen >= count.few_seen) break;
    block.project(image, model, pose, first);
    for (int k = 0; k < std::min(kCheckBlock, last - first); ++k) {
      if (block.pixel[k] < 0) continue;
      const bool look = check.facing == kFirstLook || check.facing == kLastLook;
      if (look && hopeless(check)) return check;
      ++check.facing;
      const CheckPixel& pixel = image.pixels[static_cast<std::size_t>(block.pixel[k])];
      if (pixel.depth <= 0) continue;
      const float difference = pixel.depth - block.point[2][k];
      if (difference < -depth) continue;  // hidden behind something
      ++check.seen;
      if (difference <= depth) {
        const float cosine = block.normal[0][k] * pixel.normal[0] +
                             block.normal[1][k] * pixel.normal[1] +
                             block.normal[2][k] * pixel.normal[2];
        check.agreeing += pixel.searched && cosine > cosine_127;
      } else if (difference > free_depth) {
        ++check.free_space;
      }
    }
    const bool few =
        check.seen < count.few_seen && check.agreeing > 0 && 2 * check.free_space <= check.seen;
    if (first < few_after && first + kCheckBlock >= last && few) last = std::max(last, most);
  }
  return check;
}

}  // namespace bpa::score
