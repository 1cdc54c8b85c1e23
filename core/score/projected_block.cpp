// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/projected_block.hpp"

#include <algorithm>

#include "core/base/dispatch.hpp"

namespace bpa {
namespace {

// Straight-line code over arrays, so that the compiler uses the widest vectors there are.
BPA_DISPATCH void project_block(const CheckImage& image, const CheckPoints& model,
                                const FastPose& pose, int first, float min_facing,
                                ProjectedBlock& __restrict out) {
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
    const bool faces = (a * x + b * y + c * z + min_facing * z <= 0) & (z > kNearest_m);
    const bool inside = (u >= 0) & (v >= 0) & (u < right) & (v < bottom);
    // Of points outside, numbers that an int holds.
    const int column = static_cast<int>(inside ? u : 0), row = static_cast<int>(inside ? v : 0);
    out.pixel[k] = (faces & inside) ? row * width + column : -1;
    out.point[0][k] = x;
    out.point[1][k] = y;
    out.point[2][k] = z;
    out.normal[0][k] = a;
    out.normal[1][k] = b;
    out.normal[2][k] = c;
  }
}

}  // namespace

void ProjectedBlock::project(const CheckImage& image, const CheckPoints& model,
                             const FastPose& pose, int first, float min_facing) {
  project_block(image, model, pose, first, min_facing, *this);
}

}  // namespace bpa
