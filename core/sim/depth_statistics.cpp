// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/depth_statistics.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace bpa::sim {
namespace {

constexpr double kInfraredFocal = 570.3;  // pixels
constexpr double kBaseline = 0.075;       // metres

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

KinectImage see_plate(const TriangleMesh& mesh, double depth, double angle,
                      const KinectOptions& options, std::uint64_t seed, int num_threads) {
  const Camera camera{320, 240, kInfraredFocal, kInfraredFocal, 159.5, 119.5};
  const RayMeshes meshes({&mesh});
  const Pose pose{rotation_from_vector(angle * Eigen::Vector3d::UnitY()), {0, 0, depth}};
  const RayScene scene(meshes, {{0, pose}});
  Shading shading;
  shading.materials.assign(1, {0.7, 0});
  return simulate_kinect({scene, shading, camera, Pose{}}, options, seed, 0, num_threads);
}

}  // namespace

PlaneNoise plane_noise(double depth, double angle, const KinectOptions& options, std::uint64_t seed,
                       int num_threads) {
  constexpr double kBand = 0.03;  // of the depth
  KinectOptions measured = options;
  measured.registered = false;
  const TriangleMesh wide = plate(-20, 20, 20);
  const KinectImage image = see_plate(wide, depth, angle, measured, seed, num_threads);
  Moments error;
  int missing = 0, all = 0;
  for (std::size_t i = 0; i < image.frame.depth.size(); ++i) {
    if (!(std::abs(image.ideal.depth[i] / depth - 1) <= kBand)) continue;
    ++all;
    if (image.frame.depth[i] > 0) {
      error.add(image.frame.depth[i] - image.ideal.depth[i]);
    } else {
      ++missing;
    }
  }
  // The edge's side away from the projector is a shadow's, so it is the right one that is measured.
  const TriangleMesh half = plate(-20, 0, 20);
  const KinectImage edge = see_plate(half, depth, angle, measured, seed, num_threads);
  const int width = edge.frame.camera.width;
  Moments column;
  for (int y = 0; y < edge.frame.camera.height; ++y) {
    int last = width - 1;
    const float* row = edge.frame.depth.data() + static_cast<std::size_t>(y) * width;
    while (last >= 0 && row[last] == 0) --last;
    if (last >= 0) column.add(last);
  }
  return {error.deviation(), column.deviation(), all > 0 ? static_cast<double>(missing) / all : 0};
}

namespace {

// The rectangle of rows and columns of which at least a third is measured.
struct Area {
  int left = 0, top = 0, right = -1, bottom = -1;
};

Area measured_area(const Frame& frame) {
  const int width = frame.camera.width, height = frame.camera.height;
  std::vector<int> columns(width, 0), rows(height, 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool seen = frame.depth[static_cast<std::size_t>(y) * width + x] > 0;
      columns[x] += seen;
      rows[y] += seen;
    }
  }
  Area area{0, 0, width - 1, height - 1};
  while (area.left <= area.right && 3 * columns[area.left] < height) ++area.left;
  while (area.right >= area.left && 3 * columns[area.right] < height) --area.right;
  while (area.top <= area.bottom && 3 * rows[area.top] < width) ++area.top;
  while (area.bottom >= area.top && 3 * rows[area.bottom] < width) --area.bottom;
  return area;
}

// Sizes of 4-connected regions without depth, in pixels of the frame; those that touch the area's
// border are left out.
std::vector<int> hole_sizes(const Frame& frame, const Area& area) {
  const int width = frame.camera.width;
  std::vector<std::uint8_t> visited(frame.depth.size(), 0);
  std::vector<int> sizes, stack;
  for (int y = area.top; y <= area.bottom; ++y) {
    for (int x = area.left; x <= area.right; ++x) {
      const int start = y * width + x;
      if (frame.depth[start] > 0 || visited[start]) continue;
      int size = 0;
      bool border = false;
      stack.assign(1, start);
      visited[start] = 1;
      while (!stack.empty()) {
        const int i = stack.back();
        stack.pop_back();
        ++size;
        const int u = i % width, v = i / width;
        const int next[4][2] = {{u - 1, v}, {u + 1, v}, {u, v - 1}, {u, v + 1}};
        for (const auto& [nu, nv] : next) {
          if (nu < area.left || nu > area.right || nv < area.top || nv > area.bottom) {
            border = true;
            continue;
          }
          const int n = nv * width + nu;
          if (frame.depth[n] > 0 || visited[n]) continue;
          visited[n] = 1;
          stack.push_back(n);
        }
      }
      if (!border) sizes.push_back(size);
    }
  }
  return sizes;
}

// Holes along the rows, between surfaces whose depths differ by more than 5 cm.
void add_gaps(const Frame& frame, const Area& area, Moments& left, Moments& right) {
  constexpr float kJump = 0.05f;
  constexpr int kLongest = 60;  // longer ones have other causes
  const double scale = kInfraredFocal / frame.camera.fx;
  for (int y = area.top; y <= area.bottom; ++y) {
    const float* row = frame.depth.data() + static_cast<std::size_t>(y) * frame.camera.width;
    int last = -1;
    for (int x = area.left; x <= area.right; ++x) {
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

Patch fit_patch(const Frame& frame, int x0, int y0, int size, int near_step, int far_step) {
  const int width = frame.camera.width;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  const auto disparity = [&](int x, int y) {
    return kInfraredFocal * kBaseline / frame.depth[static_cast<std::size_t>(y) * width + x];
  };
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (frame.depth[static_cast<std::size_t>(y0 + y) * width + x0 + x] <= 0) return {};
      const Eigen::Vector3d row(x - 0.5 * size, y - 0.5 * size, 1);
      a += row * row.transpose();
      b += row * disparity(x0 + x, y0 + y);
    }
  }
  const Eigen::Vector3d plane = a.ldlt().solve(b);
  const auto residual = [&](int x, int y) {
    return disparity(x0 + x, y0 + y) - plane.x() * (x - 0.5 * size) - plane.y() * (y - 0.5 * size) -
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

void add_roughness(const Frame& frame, const Area& area, DepthStatistics& statistics) {
  const double scale = frame.camera.fx / kInfraredFocal;
  const auto pixels = [scale](double p) { return std::max(1, static_cast<int>(p * scale + 0.5)); };
  const int size = pixels(20);
  std::vector<double> roughness;
  double squares = 0, near = 0, far = 0;
  for (int y = area.top; y + size <= area.bottom + 1; y += size) {
    for (int x = area.left; x + size <= area.right + 1; x += size) {
      const Patch patch = fit_patch(frame, x, y, size, pixels(1.5), pixels(5));
      if (patch.rms <= 0) continue;
      roughness.push_back(patch.rms);
      squares += patch.rms * patch.rms;
      near += patch.near_product;
      far += patch.far_product;
    }
  }
  if (roughness.empty()) return;
  const auto middle = roughness.begin() + static_cast<std::ptrdiff_t>(roughness.size() / 2);
  std::nth_element(roughness.begin(), middle, roughness.end());
  statistics.roughness = *middle;
  statistics.near_correlation = near / squares;
  statistics.far_correlation = far / squares;
}

}  // namespace

DepthStatistics depth_statistics(const Frame& frame) {
  DepthStatistics statistics;
  const Area area = measured_area(frame);
  const double count =
      static_cast<double>(area.right - area.left + 1) * std::max(area.bottom - area.top + 1, 0);
  if (!(count > 0)) return statistics;
  int missing = 0;
  for (int y = area.top; y <= area.bottom; ++y) {
    for (int x = area.left; x <= area.right; ++x) {
      missing += frame.depth[static_cast<std::size_t>(y) * frame.camera.width + x] <= 0;
    }
  }
  statistics.missing = missing / count;
  const double scale = frame.camera.fx / kInfraredFocal;
  constexpr double kSmall = 20;  // square pixels
  int small = 0;
  for (const int size : hole_sizes(frame, area)) small += size <= kSmall * scale * scale;
  statistics.small_holes = small / (count / (scale * scale)) * 1e4;
  Moments left, right;
  add_gaps(frame, area, left, right);
  statistics.left_gap = left.mean();
  statistics.right_gap = right.mean();
  add_roughness(frame, area, statistics);
  return statistics;
}

}  // namespace bpa::sim
