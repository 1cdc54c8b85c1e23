// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/core/sim/depth_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/base/median.hpp"
#include "core/geometry/solve_symmetric.hpp"
#include "tests/support/infrared_camera.hpp"

namespace bpa::sim {
namespace {

constexpr double kInfraredFocal = 570.3;   // pixels
constexpr double kKinectBaseline = 0.075;  // metres

struct Moments {
  double sum = 0, squares = 0;
  int count = 0;

  void add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  double mean() const { return count > 0 ? sum / count : 0; }
  double deviation() const {
    return count > 0 ? std::sqrt(std::max(squares / count - mean() * mean(), 0.0)) : 0;
  }
};

TriangleMesh plate(double left, double right, double half_height) {
  const auto l = static_cast<float>(left), r = static_cast<float>(right);
  const auto h = static_cast<float>(half_height);
  TriangleMesh mesh;
  mesh.vertices = {{l, -h, 0}, {r, -h, 0}, {r, h, 0}, {l, h, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

SensorImage see_plate(const TriangleMesh& mesh, double depth, double angle,
                      const SensorOptions& options, std::uint64_t seed, int num_threads) {
  const double focal = infrared_focal(options);
  const Camera camera{320, 240, focal, focal, 159.5, 119.5};
  const RayMeshes meshes({&mesh});
  const Pose pose{rotation_from_vector(angle * Eigen::Vector3d::UnitY()), {0, 0, depth}};
  const RayScene scene(meshes, {{0, pose}});
  Shading shading;
  shading.materials.assign(1, {0.7, 0});
  return simulate_sensor({scene, shading, camera, Pose{}}, options, seed, 0, num_threads);
}

using DepthImage = cv::Mat_<float>;

// The rectangle of rows and columns of which at least a third is measured.
DepthImage measured_part(const DepthImage& depth) {
  const auto range = [&depth](int dimension) {
    cv::Mat_<int> seen;
    cv::reduce((depth > 0) & 1, seen, dimension, cv::REDUCE_SUM, CV_32S);
    const int all = dimension == 0 ? depth.rows : depth.cols;
    int first = 0, last = static_cast<int>(seen.total());
    while (first < last && 3 * seen(first) < all) ++first;
    while (last > first && 3 * seen(last - 1) < all) --last;
    return cv::Range(first, last);
  };
  return depth(range(1), range(0));
}

// The 4-connected regions without depth, of at most `most` pixels, that do not touch the border.
int count_holes(const DepthImage& depth, double most) {
  cv::Mat labels, centroids;
  cv::Mat_<int> regions;
  cv::connectedComponentsWithStats(depth <= 0, labels, regions, centroids, 4);
  int holes = 0;
  for (int i = 1; i < regions.rows; ++i) {
    const int left = regions(i, cv::CC_STAT_LEFT), top = regions(i, cv::CC_STAT_TOP);
    const bool inside = left > 0 && left + regions(i, cv::CC_STAT_WIDTH) < depth.cols && top > 0 &&
                        top + regions(i, cv::CC_STAT_HEIGHT) < depth.rows;
    holes += inside && regions(i, cv::CC_STAT_AREA) <= most;
  }
  return holes;
}

// Holes along the rows, between surfaces over 5 cm apart in depth; `scale` times the pixels.
void add_gaps(const DepthImage& depth, double scale, Moments& left, Moments& right) {
  constexpr float kJump = 0.05f;
  constexpr int kLongest = 60;  // longer ones have other causes
  for (int y = 0; y < depth.rows; ++y) {
    const float* row = depth[y];
    int last = -1;
    for (int x = 0; x < depth.cols; ++x) {
      if (row[x] <= 0) continue;
      if (last >= 0 && std::abs(row[x] - row[last]) > kJump && scale * (x - last) < kLongest) {
        (row[x] < row[last] ? left : right).add(scale * (x - last - 1));
      }
      last = x;
    }
  }
}

// Residuals of one square patch about the plane that fits best; a plane is linear in 1/depth.
struct Patch {
  double rms = -1;  ///< Pixels of disparity; negative where the patch is no plane.
  double near_product = 0, far_product = 0;  ///< Mean product of residuals so far apart.
};

Patch fit_patch(const DepthImage& depth, int near_step, int far_step) {
  const int size = depth.rows;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  const auto disparity = [&](int x, int y) {
    return kInfraredFocal * kKinectBaseline / depth(y, x);
  };
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (depth(y, x) <= 0) return {};
      const Eigen::Vector3d row(x - 0.5 * size, y - 0.5 * size, 1);
      a += row * row.transpose();
      b += row * disparity(x, y);
    }
  }
  const Eigen::Vector3d plane = solve_symmetric(a, b);
  const auto residual = [&](int x, int y) {
    return disparity(x, y) - plane.x() * (x - 0.5 * size) - plane.y() * (y - 0.5 * size) -
           plane.z();
  };
  Moments squares, near, far;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double r = residual(x, y);
      squares.add(r * r);
      if (x + near_step < size) near.add(r * residual(x + near_step, y));
      if (x + far_step < size) far.add(r * residual(x + far_step, y));
    }
  }
  constexpr double kFlat = 0.5;  // pixels of disparity
  const double rms = std::sqrt(squares.mean());
  return {rms < kFlat ? rms : -1, near.mean(), far.mean()};
}

void add_roughness(const DepthImage& depth, double scale, DepthStatistics& statistics) {
  const auto pixels = [scale](double p) { return std::max(1, static_cast<int>(p * scale + 0.5)); };
  const int size = pixels(20);
  std::vector<double> roughness;
  double squares = 0, near = 0, far = 0;
  for (int y = 0; y + size <= depth.rows; y += size) {
    for (int x = 0; x + size <= depth.cols; x += size) {
      const Patch patch = fit_patch(depth({x, y, size, size}), pixels(1.5), pixels(5));
      if (patch.rms <= 0) continue;
      roughness.push_back(patch.rms);
      squares += patch.rms * patch.rms;
      near += patch.near_product;
      far += patch.far_product;
    }
  }
  if (roughness.empty()) return;
  statistics.roughness = median(roughness);
  statistics.near_correlation = near / squares;
  statistics.far_correlation = far / squares;
}

}  // namespace

PlaneNoise plane_noise(double depth, double angle, const SensorOptions& options, std::uint64_t seed,
                       int num_threads) {
  constexpr double kBand = 0.03;  // of the depth
  const SensorOptions measured = unregistered(options);
  const TriangleMesh wide = plate(-20, 20, 20);
  const SensorImage image = see_plate(wide, depth, angle, measured, seed, num_threads);
  Moments error, missing;
  for (std::size_t i = 0; i < image.frame.depth.size(); ++i) {
    if (!(std::abs(image.ideal.depth[i] / depth - 1) <= kBand)) continue;
    const float measured_depth = image.frame.depth[i];
    missing.add(measured_depth > 0 ? 0 : 1);
    if (measured_depth > 0) error.add(measured_depth - image.ideal.depth[i]);
  }
  // The edge's side away from the projector is a shadow's, so it is the right one that is measured.
  const TriangleMesh half = plate(-20, 0, 20);
  const SensorImage edge = see_plate(half, depth, angle, measured, seed, num_threads);
  const int width = edge.frame.camera.width;
  Moments column;
  for (int y = 0; y < edge.frame.camera.height; ++y) {
    int last = width - 1;
    const float* row = edge.frame.depth.data() + static_cast<std::size_t>(y) * width;
    while (last >= 0 && row[last] == 0) --last;
    if (last >= 0) column.add(last);
  }
  return {error.deviation(), column.deviation(), missing.mean()};
}

DepthStatistics depth_statistics(const Frame& frame) {
  constexpr double kSmall = 20;  // square pixels
  const DepthImage depth = measured_part(
      DepthImage(frame.camera.height, frame.camera.width, const_cast<float*>(frame.depth.data())));
  if (depth.empty()) return {};
  const double count = static_cast<double>(depth.total());
  const double scale = frame.camera.fx / kInfraredFocal;
  DepthStatistics statistics;
  statistics.missing = cv::countNonZero(depth <= 0) / count;
  statistics.small_holes =
      count_holes(depth, kSmall * scale * scale) / (count / (scale * scale)) * 1e4;
  Moments left, right;
  add_gaps(depth, kInfraredFocal / frame.camera.fx, left, right);
  statistics.left_gap = left.mean();
  statistics.right_gap = right.mean();
  add_roughness(depth, scale, statistics);
  return statistics;
}

}  // namespace bpa::sim
