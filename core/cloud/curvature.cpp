// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/curvature.hpp"

#include <cmath>

#include "core/base/parallel.hpp"
#include "core/cloud/neighbor_grid.hpp"

namespace bpa {
namespace {

constexpr float kMinCosine = -0.17f;  // of 100 degrees: beyond it is the far side of a thin wall

struct TangentCovariance {
  float uu = 0, uv = 0, vv = 0;
  int count = 0;
};

// Eigenvalues c1 >= c2 and the eigenvector of c1, as (cosine, sine) in the tangent basis.
void decompose(const TangentCovariance& c, Eigen::Vector2f& values, Eigen::Vector2f& direction) {
  const float half_trace = 0.5f * (c.uu + c.vv);
  const float half_difference = 0.5f * (c.uu - c.vv);
  const float root = std::sqrt(half_difference * half_difference + c.uv * c.uv);
  values = Eigen::Vector2f(half_trace + root, std::max(0.0f, half_trace - root)) /
           static_cast<float>(std::max(1, c.count));
  const float angle = 0.5f * std::atan2(2 * c.uv, c.uu - c.vv);
  direction = {std::cos(angle), std::sin(angle)};
}

}  // namespace

void estimate_curvature(PointCloud& cloud, float radius, int num_threads) {
  const NeighborGrid grid(cloud.points, radius);
  cloud.principal_directions.resize(cloud.size());
  cloud.curvatures.resize(cloud.size());
  parallel_for(cloud.size(), num_threads, [&](std::size_t i) {
    const Eigen::Vector3f normal = cloud.normals[i];
    const Eigen::Vector3f u = normal.unitOrthogonal();
    const Eigen::Vector3f v = normal.cross(u);
    TangentCovariance covariance;
    grid.for_each_neighbor(cloud.points[i], [&](int j, float) {
      const Eigen::Vector3f& other = cloud.normals[j];
      if (other.dot(normal) < kMinCosine) return;
      const float a = other.dot(u);
      const float b = other.dot(v);
      covariance.uu += a * a;
      covariance.uv += a * b;
      covariance.vv += b * b;
      ++covariance.count;
    });
    Eigen::Vector2f direction;
    decompose(covariance, cloud.curvatures[i], direction);
    cloud.principal_directions[i] = (direction.x() * u + direction.y() * v).normalized();
  });
}

}  // namespace bpa
