// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/pose_check.hpp"

#include <algorithm>

#include "core/base/dispatch.hpp"

namespace bpa {
namespace {

// Facing points after which a hopeless pose is rejected. Most poses are rejected at the first look.
constexpr int kFirstLook = 8;
constexpr int kLastLook = 24;
constexpr float kMinFacing = 0.15f;  // cosine between normal and line of sight, on the optical axis

bool hopeless(const PoseCheck& check) {
  if (check.facing == kFirstLook) {
    return check.seen > 4 && (check.agreeing == 0 || 2 * check.free_space > check.seen);
  }
  return check.seen > 8 && (5 * check.free_space > 2 * check.seen ||  //
                            5 * check.agreeing < check.seen);
}

// What a block of model points looks like from the camera.
struct Block {
  float z[kCheckBlock];
  float normal[3][kCheckBlock];
  int pixel[kCheckBlock];  // negative where the point faces away or is outside the image
};

// Straight-line code over arrays, so that the compiler uses the widest vectors there are.
BPA_DISPATCH void project_block(const CheckImage& image, const CheckPoints& model,
                                const FastPose& pose, int first, Block& __restrict out) {
  float r[9];  // column by column
  std::copy_n(pose.rotation.data(), 9, r);
  const Eigen::Vector3f& t = pose.translation;
  const float tx = t.x(), ty = t.y(), tz = t.z();
  const float fx = image.fx, fy = image.fy, cx = image.cx + 0.5f, cy = image.cy + 0.5f;
  const int width = image.width, height = image.height;
  const auto right = static_cast<float>(width), bottom = static_cast<float>(height);
  const float* px = model.coordinates[0].data() + first;
  const float* py = model.coordinates[1].data() + first;
  const float* pz = model.coordinates[2].data() + first;
  const float* nx = model.coordinates[3].data() + first;
  const float* ny = model.coordinates[4].data() + first;
  const float* nz = model.coordinates[5].data() + first;
  for (int k = 0; k < kCheckBlock; ++k) {
    const float x = r[0] * px[k] + r[3] * py[k] + r[6] * pz[k] + tx;
    const float y = r[1] * px[k] + r[4] * py[k] + r[7] * pz[k] + ty;
    const float z = r[2] * px[k] + r[5] * py[k] + r[8] * pz[k] + tz;
    const float a = r[0] * nx[k] + r[3] * ny[k] + r[6] * nz[k];
    const float b = r[1] * nx[k] + r[4] * ny[k] + r[7] * nz[k];
    const float c = r[2] * nx[k] + r[5] * ny[k] + r[8] * nz[k];
    const float inverse_z = 1 / z;
    const float u = fx * x * inverse_z + cx, v = fy * y * inverse_z + cy;
    const bool faces = (a * x + b * y + c * z + kMinFacing * z <= 0) & (z > kNearest_m);
    const bool inside = (u >= 0) & (v >= 0) & (u < right) & (v < bottom);
    // Of points outside, numbers that an int holds.
    const int column = static_cast<int>(inside ? u : 0), row = static_cast<int>(inside ? v : 0);
    out.pixel[k] = (faces & inside) ? row * width + column : -1;
    out.z[k] = z;
    out.normal[0][k] = a;
    out.normal[1][k] = b;
    out.normal[2][k] = c;
  }
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
  Block block;
  for (int first = 0; first < last; first += kCheckBlock) {
    if (first >= few_after && check.seen >= count.few_seen) break;
    project_block(image, model, pose, first, block);
    for (int k = 0; k < std::min(kCheckBlock, last - first); ++k) {
      if (block.pixel[k] < 0) continue;
      const bool look = check.facing == kFirstLook || check.facing == kLastLook;
      if (look && hopeless(check)) return check;
      ++check.facing;
      const CheckPixel& pixel = image.pixels[static_cast<std::size_t>(block.pixel[k])];
      if (pixel.depth <= 0) continue;
      const float difference = pixel.depth - block.z[k];
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

}  // namespace bpa
