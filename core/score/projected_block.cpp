// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/projected_block.hpp"

#include "core/base/dispatch.hpp"
#include "core/score/projection.hpp"

namespace bpa::score {
namespace {

// Straight-line code over arrays, so that the compiler uses the widest vectors there are.
BPA_DISPATCH void project_block(const CheckImage& image, const CheckPoints& model,
                                const FastPose& pose, int first, float min_facing,
                                ProjectedBlock& __restrict out) {
  const Projection camera(image, pose);
  const float* px = model.coordinates[0].data() + first;
  const float* py = model.coordinates[1].data() + first;
  const float* pz = model.coordinates[2].data() + first;
  const float* nx = model.coordinates[3].data() + first;
  const float* ny = model.coordinates[4].data() + first;
  const float* nz = model.coordinates[5].data() + first;
  for (int k = 0; k < kCheckBlock; ++k) {
    const Coordinates p = camera.moved(px[k], py[k], pz[k]);
    const Coordinates n = camera.turned(nx[k], ny[k], nz[k]);
    const bool faces = n.x * p.x + n.y * p.y + n.z * p.z + min_facing * p.z <= 0;
    out.pixel[k] = camera.pixel_by_inverse(p, faces);
    out.point[0][k] = p.x, out.point[1][k] = p.y, out.point[2][k] = p.z;
    out.normal[0][k] = n.x, out.normal[1][k] = n.y, out.normal[2][k] = n.z;
  }
}

}  // namespace

void ProjectedBlock::project(const CheckImage& image, const CheckPoints& model,
                             const FastPose& pose, int first, float min_facing) {
  project_block(image, model, pose, first, min_facing, *this);
}

}  // namespace bpa::score
