// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/surface_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/base/dispatch.hpp"
#include "core/base/parallel.hpp"

namespace bpa {
namespace {

// Chosen by hand, as all numbers of this file.
constexpr float kGatePerPixel = 0.004f;        // what a slope adds to the gate, metres per pixel
constexpr int kMinWindow = 2, kMaxWindow = 8;  // radius of the normal's window, pixels
constexpr int kDenseWindow = 4;                // larger windows take every second pixel
constexpr int kMinNormalPoints = 6;
constexpr int kMaxReduction = 8;

// Depths of one surface differ by less than this within a few pixels, unless it is seen at a
// grazing angle. Metres.
float same_surface_gate(const SensorNoise& noise, float z) { return tolerance::kGoesOn(noise(z)); }

Camera reduced_camera(const Camera& camera, int reduction) {
  const double scale = 1.0 / reduction;
  const double shift = 0.5 * (reduction - 1);
  return {camera.width / reduction, camera.height / reduction,   camera.fx * scale,
          camera.fy * scale,        (camera.cx - shift) * scale, (camera.cy - shift) * scale};
}

// Calls visit(u, v, depth) for the pixels of the frame that pixel (column, row) of the map stands
// for.
void for_each_of_block(const Frame& frame, int column, int row, int reduction, const auto& visit) {
  for (int v = row * reduction; v < (row + 1) * reduction; ++v) {
    for (int u = column * reduction; u < (column + 1) * reduction; ++u) {
      visit(u, v, frame.depth[v * frame.camera.width + u]);
    }
  }
}

// Without branches for a full block of two by two pixels, as most are.
void sort(float* values, int count) {
  if (count != 4) {
    std::sort(values, values + count);
    return;
  }
  const auto order = [&](int a, int b) {
    const float least = std::min(values[a], values[b]);
    values[b] = std::max(values[a], values[b]);
    values[a] = least;
  };
  order(0, 1), order(2, 3), order(0, 2), order(1, 3), order(1, 2);
}

// The mean of the block's depths near its median, 0 when less than half of the block has a depth.
float block_depth(const Frame& frame, const SensorNoise& noise, int column, int row,
                  int reduction) {
  float values[kMaxReduction * kMaxReduction];
  int count = 0;
  for_each_of_block(frame, column, row, reduction, [&](int, int, float z) {
    if (z > 0 && std::isfinite(z)) values[count++] = z;
  });
  if (2 * count < reduction * reduction) return 0;
  sort(values, count);
  const float median = values[(count - 1) / 2];
  float sum = 0;
  int used = 0;
  for (int i = 0; i < count; ++i) {
    if (std::abs(values[i] - median) > same_surface_gate(noise, median)) continue;
    sum += values[i];
    ++used;
  }
  return sum / static_cast<float>(used);
}

bool pixel_searched(const Frame& frame, int u, int v) {
  const RegionOfInterest& roi = frame.roi;
  if (!roi.empty() &&
      (u < roi.x || v < roi.y || u >= roi.x + roi.width || v >= roi.y + roi.height)) {
    return false;
  }
  const int index = v * frame.camera.width + u;
  if (!frame.mask.empty() && frame.mask[index] == 0) return false;
  return frame.background.empty() || frame.background[index] == 0;
}

// Whether at least half of the block's pixels on the surface at `depth`, which stands for the
// block, are searched. Any of them would let a mask grow by up to a block to each side, and all of
// them shrink it; half keeps its area, and pixels on another surface have no say.
bool block_searched(const Frame& frame, const SensorNoise& noise, int column, int row,
                    int reduction, float depth) {
  int searched = 0, on_surface = 0;
  for_each_of_block(frame, column, row, reduction, [&](int u, int v, float z) {
    if (!(std::abs(z - depth) <= same_surface_gate(noise, depth))) return;
    ++on_surface;
    searched += pixel_searched(frame, u, v);
  });
  return searched > 0 && 2 * searched >= on_surface;
}

// A window of the depth image: pixels that far from its centre, every `step`-th of them.
struct Window {
  int radius, step;

  explicit Window(int pixels) : radius(pixels), step(pixels > kDenseWindow ? 2 : 1) {}
};

// How far depths of the window's pixels on one surface may be apart, metres.
float window_gate(const SensorNoise& noise, float depth, const Window& window) {
  return same_surface_gate(noise, depth) + kGatePerPixel * static_cast<float>(window.radius);
}

// Eight windows at a time, of neighbouring pixels.
constexpr int kLanes = 8;
using Lanes = float __attribute__((vector_size(sizeof(float) * kLanes)));
using LaneMask = int __attribute__((vector_size(sizeof(int) * kLanes)));

// The map's points as three images. A border without depth is around them, so that windows may
// leave the map.
class PointImages {
 public:
  explicit PointImages(const SurfaceMap& map)
      : width_(map.width() + 2 * kMaxWindow + kLanes),
        x_(static_cast<std::size_t>(width_) * (map.height() + 2 * kMaxWindow)),
        y_(x_.size()),
        z_(x_.size()) {
    for (int v = 0; v < map.height(); ++v) {
      for (int u = 0; u < map.width(); ++u) {
        const Eigen::Vector3f& point = map.points[static_cast<std::size_t>(v) * map.width() + u];
        const std::size_t to = index(u, v);
        x_[to] = point.x(), y_[to] = point.y(), z_[to] = point.z();
      }
    }
  }

  int width() const { return width_; }
  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v + kMaxWindow) * width_ + u + kMaxWindow;
  }
  const float* x() const { return x_.data(); }
  const float* y() const { return y_.data(); }
  const float* z() const { return z_.data(); }

 private:
  int width_;
  std::vector<float> x_, y_, z_;
};

// Sums over the points of eight windows, relative to their centres, metres.
struct Moments {
  Lanes sx{}, sy{}, sz{}, xx{}, xy{}, xz{}, yy{}, yz{}, zz{}, count{};
};

// The windows of the pixels from `centre` on that `wanted` names, each with its gate.
BPA_DISPATCH void add_windows(const PointImages& points, std::size_t centre, const Window& window,
                              const Lanes& gate, const LaneMask& wanted, Moments& out) {
  const auto load = [](const float* values, Lanes& lanes) {
    std::memcpy(&lanes, values, sizeof lanes);
  };
  const float *const px = points.x(), *const py = points.y(), *const pz = points.z();
  Lanes x0, y0, z0;
  load(px + centre, x0), load(py + centre, y0), load(pz + centre, z0);
  const Lanes limit = gate, none{}, one = none + 1;
  const LaneMask these = wanted;
  Moments sums = out;
  for (int row = -window.radius; row <= window.radius; row += window.step) {
    const std::size_t first = centre + static_cast<std::ptrdiff_t>(row) * points.width();
    for (std::size_t i = first - window.radius; i <= first + window.radius; i += window.step) {
      Lanes x, y, z;
      load(px + i, x), load(py + i, y), load(pz + i, z);
      const Lanes away = z - z0;
      const LaneMask near = (z > none) & (away <= limit) & (away >= -limit) & these;
      const Lanes dx = near ? x - x0 : none, dy = near ? y - y0 : none, dz = near ? away : none;
      sums.sx += dx, sums.sy += dy, sums.sz += dz;
      sums.xx += dx * dx, sums.xy += dx * dy, sums.xz += dx * dz;
      sums.yy += dy * dy, sums.yz += dy * dz, sums.zz += dz * dz;
      sums.count += near ? one : none;
    }
  }
  out = sums;
}

// The normals of the planes fitted to eight windows' points, toward the camera; zero with fewer
// than kMinNormalPoints. `x`, `y`, `z`: the windows' centres. A normal is the eigenvector of the
// scatter's least eigenvalue. Newton's method finds that from 0 on: left of its least root the
// characteristic polynomial is concave, so that no step goes too far. Without branches, so that
// loops become vectors.
BPA_DISPATCH void fit_planes(const Moments& m, const float* __restrict x, const float* __restrict y,
                             const float* __restrict z, float (&__restrict normal)[3][kLanes]) {
  float moments[10][kLanes];
  std::memcpy(moments, &m, sizeof m);
  const auto& [sx, sy, sz, sxx, sxy, sxz, syy, syz, szz, count] = moments;
  for (int k = 0; k < kLanes; ++k) {
    const bool enough = count[k] >= kMinNormalPoints;
    const float n = 1 / (enough ? count[k] : 1);
    float xx = sxx[k] - sx[k] * sx[k] * n, yy = syy[k] - sy[k] * sy[k] * n;
    float zz = szz[k] - sz[k] * sz[k] * n;
    const float trace = xx + yy + zz;
    const bool spread = enough & (trace > 0);
    const float scale = 1 / (spread ? trace : 1);
    xx *= scale, yy *= scale, zz *= scale;
    const float xy = (sxy[k] - sx[k] * sy[k] * n) * scale,
                xz = (sxz[k] - sx[k] * sz[k] * n) * scale;
    const float yz = (syz[k] - sy[k] * sz[k] * n) * scale;
    // The polynomial: t^3 - t^2 + minors t - det, as the trace is 1.
    const float xx_minor = yy * zz - yz * yz, xy_minor = xy * zz - yz * xz;
    const float xz_minor = xy * yz - yy * xz;
    const float minors = xx_minor + (xx * zz - xz * xz) + (xx * yy - xy * xy);
    const float det = xx * xx_minor - xy * xy_minor + xz * xz_minor;
    float root = 0;
    constexpr int kSteps = 6;  // chosen by hand
#pragma GCC unroll kSteps
    for (int step = 0; step < kSteps; ++step) {
      const float value = ((root - 1) * root + minors) * root - det;
      const float slope = (3 * root - 2) * root + minors;
      root -= slope > 0 ? value / slope : 0;
    }
    xx -= root, yy -= root, zz -= root;
    // The rows (xx, xy, xz), (xy, yy, yz), (xz, yz, zz) span the plane: the largest of their cross
    // products.
    float nx = xy * yz - xz * yy, ny = xz * xy - xx * yz, nz = xx * yy - xy * xy;
    float squared = nx * nx + ny * ny + nz * nz;
    const auto prefer = [&](float ox, float oy, float oz) {
      const float other = ox * ox + oy * oy + oz * oz;
      const bool larger = other > squared;
      nx = larger ? ox : nx, ny = larger ? oy : ny, nz = larger ? oz : nz;
      squared = larger ? other : squared;
    };
    prefer(xy * zz - xz * yz, xz * xz - xx * zz, xx * yz - xy * xz);
    prefer(yy * zz - yz * yz, yz * xz - xy * zz, xy * yz - yy * xz);
    const bool known = spread & (squared > 0);
    const float length = std::sqrt(known ? squared : 1);
    const float toward = nx * x[k] + ny * y[k] + nz * z[k] > 0 ? -1.0f : 1.0f;
    const float factor = (known ? toward : 0) / length;
    normal[0][k] = nx * factor, normal[1][k] = ny * factor, normal[2][k] = nz * factor;
  }
}

// Radius of the window of a normal, pixels.
int window_radius(double pixels_at_1m, float depth) {
  const double pixels = pixels_at_1m / static_cast<double>(depth);
  return std::clamp(static_cast<int>(std::lround(pixels)), kMinWindow, kMaxWindow);
}

// The normals of eight pixels of a row.
void fit_normals(const PointImages& points, double pixels_at_1m, int u, int v, SurfaceMap& map) {
  const std::size_t centre = points.index(u, v);
  const int count = std::min(kLanes, map.width() - u);
  LaneMask radii{};
  int largest = 0;
  for (int k = 0; k < count; ++k) {
    const float depth = points.z()[centre + k];
    if (depth > 0) radii[k] = window_radius(pixels_at_1m, depth);
    largest = std::max(largest, radii[k]);
  }
  Moments moments;
  for (int radius = largest; radius >= kMinWindow; --radius) {
    LaneMask wanted{};
    Lanes gate{};
    bool any = false;
    for (int k = 0; k < count; ++k) {
      if (radii[k] != radius) continue;
      any = true;
      wanted[k] = -1;
      gate[k] = window_gate(map.noise, points.z()[centre + k], Window(radius));
    }
    if (any) add_windows(points, centre, Window(radius), gate, wanted, moments);
  }
  float normals[3][kLanes];
  fit_planes(moments, points.x() + centre, points.y() + centre, points.z() + centre, normals);
  for (int k = 0; k < count; ++k) {
    map.normals[static_cast<std::size_t>(v) * map.width() + u + k] = {normals[0][k], normals[1][k],
                                                                      normals[2][k]};
  }
}

}  // namespace

int map_reduction(int frame_width, int max_width) {
  int reduction = 1;
  while (frame_width / reduction > max_width && reduction < kMaxReduction) ++reduction;
  return reduction;
}

SurfaceMap surface_map(const Frame& frame, const SurfaceMapOptions& options) {
  SurfaceMap map;
  const std::optional<SensorKind> known = sensor_kind(options.sensor);
  map.sensor = known ? *known : sensor_kind_of(sensor_traits(frame));
  map.noise = noise_of(map.sensor);
  map.reduction = map_reduction(frame.camera.width, options.max_width);
  map.camera = reduced_camera(frame.camera, map.reduction);
  const int width = map.width();
  const int size = width * map.height();
  map.depth.resize(size);
  map.points.resize(size);
  map.normals.assign(size, Eigen::Vector3f::Zero());
  map.searched.assign(size, 0);
  parallel_for(map.height(), options.num_threads, [&](int v) {
    for (int u = 0; u < width; ++u) {
      const int i = v * width + u;
      const float z = block_depth(frame, map.noise, u, v, map.reduction);
      map.depth[i] = z;
      map.points[i] = map.camera.unproject(u, v, z).cast<float>();
      map.searched[i] = z > 0 && z <= static_cast<float>(options.max_range_m) &&
                        block_searched(frame, map.noise, u, v, map.reduction, z);
    }
  });
  const PointImages points(map);
  const double pixels_at_1m = options.normal_radius_m * map.camera.fx;
  parallel_for(map.height(), options.num_threads, [&](int v) {
    for (int u = 0; u < width; u += kLanes) fit_normals(points, pixels_at_1m, u, v, map);
  });
  return map;
}

}  // namespace bpa
