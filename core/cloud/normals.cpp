// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/normals.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/base/parallel.hpp"
#include "core/cloud/neighbor_grid.hpp"

namespace bpa {

void estimate_normals(PointCloud& cloud, float radius, const Eigen::Vector3f& viewpoint,
                      int num_threads) {
  const NeighborGrid grid(cloud.points, radius);
  cloud.normals.assign(cloud.size(), Eigen::Vector3f::Zero());
  parallel_for(cloud.size(), num_threads, [&](std::size_t i) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
    int count = 0;
    grid.for_each_neighbor(cloud.points[i], [&](int j, float) {
      const Eigen::Vector3f d = cloud.points[j] - cloud.points[i];
      sum += d;
      squares += d * d.transpose();
      ++count;
    });
    if (count < 3) return;
    const Eigen::Matrix3f scatter = squares - sum * sum.transpose() / static_cast<float>(count);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(scatter);
    Eigen::Vector3f normal = solver.eigenvectors().col(0);
    if (normal.dot(viewpoint - cloud.points[i]) < 0) normal = -normal;
    cloud.normals[i] = normal;
  });
}

bool mend_normals(std::vector<Eigen::Vector3f>& normals,
                  const std::vector<Eigen::Vector3f>& computed) {
  constexpr float kMinCosine = 0.5f;
  std::vector<std::size_t> broken;
  std::size_t known = 0, along = 0, against = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const bool usable = normals[i].allFinite() && normals[i].squaredNorm() > 0.25f;
    if (!usable) broken.push_back(i);
    if (computed[i].squaredNorm() == 0) continue;
    const float cosine = usable ? normals[i].dot(computed[i].normalized()) : 0;
    ++known;
    along += cosine > kMinCosine;
    against += cosine < -kMinCosine;
  }
  if (5 * broken.size() >= normals.size() || 5 * (along + against) < 4 * known) return false;
  const float sign = along < against ? -1 : 1;
  for (const std::size_t i : broken) normals[i] = sign * computed[i].normalized();
  return true;
}

void mend_normals(TriangleMesh& mesh) {
  if (mesh.normals.empty()) return;
  std::vector<Eigen::Vector3f> computed(mesh.vertices.size(), Eigen::Vector3f::Zero());
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3f& a = mesh.vertices[triangle[0]];
    const Eigen::Vector3f cross =
        (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a);
    for (const std::uint32_t corner : triangle) computed[corner] += cross;
  }
  if (!mend_normals(mesh.normals, computed)) mesh.normals.clear();
}

}  // namespace bpa
