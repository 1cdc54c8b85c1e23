// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/planes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/base/dispatch.hpp"
#include "core/base/random.hpp"

namespace bpa {
namespace {

// Chosen by hand, as all numbers of this file.
constexpr float kMinNormalCosine = 0.95f;     // of an inlier
constexpr float kMinBackgroundCosine = 0.8f;  // of a pixel that is labelled background
constexpr std::size_t kCountedPixels = 1500;  // about as many are tested for each draw
constexpr std::size_t kMinCandidates = 100;   // pixels; with fewer the search ends
constexpr int kMinInliers = 10;
constexpr int kFits = 3;

using Indices = std::vector<std::size_t>;  // of pixels

bool on_plane(const SurfaceMap& map, std::size_t i, const Plane& plane) {
  return std::abs(plane.height(map.points[i])) < tolerance::kOnSurface(map.noise(map.depth[i]));
}

struct PlaneFit {
  Plane plane;
  double extent = 0;
  int count = 0;
};

PlaneFit fit(const SurfaceMap& map, const Indices& candidates, const Plane& start) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  PlaneFit result;
  for (const std::size_t i : candidates) {
    if (!on_plane(map, i, start) || map.normals[i].dot(start.normal) < kMinNormalCosine) continue;
    const Eigen::Vector3d p = map.points[i].cast<double>();
    sum += p;
    squares += p * p.transpose();
    ++result.count;
  }
  if (result.count < kMinInliers) return result;
  const Eigen::Vector3d mean = sum / result.count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares / result.count -
                                                              mean * mean.transpose());
  Eigen::Vector3d normal = solver.eigenvectors().col(0);
  if (normal.dot(mean) > 0) normal = -normal;
  result.plane = {normal.cast<float>(), static_cast<float>(normal.dot(mean))};
  result.extent = std::sqrt(12 * std::sqrt(solver.eigenvalues()[1] * solver.eigenvalues()[2]));
  return result;
}

// How many pixels are on the plane and have about its normal. Straight-line code over arrays, so
// that the compiler uses the widest vectors there are.
BPA_DISPATCH int count_inliers(const float* __restrict x, const float* __restrict y,
                               const float* __restrict z, const float* __restrict nx,
                               const float* __restrict ny, const float* __restrict nz,
                               const float* __restrict tolerance, int size, float a, float b,
                               float c, float offset) {
  int count = 0;
  for (int k = 0; k < size; ++k) {
    const float height = a * x[k] + b * y[k] + c * z[k] - offset;
    const float cosine = nx[k] * a + ny[k] * b + nz[k] * c;
    count += (std::abs(height) < tolerance[k]) & (cosine > kMinNormalCosine);
  }
  return count;
}

// The pixels that draws are tested on, every few of the candidates, in the form that the test
// reads.
class Counted {
 public:
  Counted(const SurfaceMap& map, const Indices& candidates) {
    const std::size_t step = std::max<std::size_t>(1, candidates.size() / kCountedPixels);
    for (std::size_t k = 0; k < candidates.size(); k += step) {
      const std::size_t i = candidates[k];
      for (int axis = 0; axis < 3; ++axis) {
        point_[axis].push_back(map.points[i][axis]);
        normal_[axis].push_back(map.normals[i][axis]);
      }
      tolerance_.push_back(tolerance::kOnSurface(map.noise(map.depth[i])));
    }
  }
  int inliers(const Plane& plane) const {
    return count_inliers(point_[0].data(), point_[1].data(), point_[2].data(), normal_[0].data(),
                         normal_[1].data(), normal_[2].data(), tolerance_.data(),
                         static_cast<int>(tolerance_.size()), plane.normal.x(), plane.normal.y(),
                         plane.normal.z(), plane.offset);
  }

 private:
  std::vector<float> point_[3], normal_[3], tolerance_;
};

PlaneFit best_plane(const SurfaceMap& map, const Indices& candidates, const PlaneOptions& options,
                    std::uint64_t stream) {
  RandomStream random(options.seed, stream);
  Plane best;
  int best_count = -1;
  const Counted counted(map, candidates);
  for (int draw = 0; draw < options.num_samples; ++draw) {
    const std::size_t i = candidates[random.index(static_cast<int>(candidates.size()))];
    const Plane plane{map.normals[i], map.normals[i].dot(map.points[i])};
    const int count = counted.inliers(plane);
    if (count > best_count) {
      best_count = count;
      best = plane;
    }
  }
  PlaneFit result{best};
  for (int iteration = 0; iteration < kFits; ++iteration) {
    result = fit(map, candidates, result.plane);
    if (result.count < kMinInliers) break;
  }
  return result;
}

}  // namespace

std::vector<Plane> label_background_planes(SurfaceMap& map, const PlaneOptions& options) {
  if (!options.label_planes) return {};
  Indices candidates;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.searched[i] && map.normals[i].squaredNorm() > 0) candidates.push_back(i);
  }
  const double min_count = options.min_fraction * static_cast<double>(candidates.size());
  std::vector<Plane> planes;
  for (int k = 0; k < options.max_planes && candidates.size() > kMinCandidates; ++k) {
    const PlaneFit found = best_plane(map, candidates, options, static_cast<std::uint64_t>(k));
    if (found.count < min_count || found.extent < options.min_extent_m) break;
    planes.push_back(found.plane);
    label_background(map, found.plane);
    std::erase_if(candidates, [&](std::size_t i) { return !map.searched[i]; });
  }
  return planes;
}

void label_background(SurfaceMap& map, const Plane& plane) {
  for (std::size_t i = 0; i < map.size(); ++i) {
    // Pixels on the plane whose normal says otherwise belong to something standing on it.
    const bool agrees = map.normals[i].squaredNorm() == 0 ||
                        map.normals[i].dot(plane.normal) > kMinBackgroundCosine;
    if (map.searched[i] && agrees && on_plane(map, i, plane)) map.searched[i] = 0;
  }
}

Plane transformed(const Pose& a_from_b, const Plane& plane) {
  const FastPose pose = to_fast(a_from_b);
  const Eigen::Vector3f normal = pose.rotation * plane.normal;
  return {normal, plane.offset + normal.dot(pose.translation)};
}

}  // namespace bpa
