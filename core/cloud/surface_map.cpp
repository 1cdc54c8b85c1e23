// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/surface_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/base/dispatch.hpp"
#include "core/base/parallel.hpp"

namespace bpa {
namespace {

// Chosen by hand, as all numbers of this file.
constexpr float kGateFloor = 0.008f;           // metres
constexpr float kGateSigmas = 4;               // standard deviations of depth
constexpr float kGatePerPixel = 0.004f;        // what a slope adds to the gate, metres per pixel
constexpr int kMinWindow = 2, kMaxWindow = 8;  // radius of the normal's window, pixels
constexpr int kDenseWindow = 4;                // larger windows take every second pixel
constexpr int kMinNormalPoints = 6;
constexpr int kMaxReduction = 8;

// Depths of one surface differ by less than this within a few pixels, unless it is seen at a
// grazing angle. Metres.
float same_surface_gate(const SensorNoise& noise, float z) {
  return kGateFloor + kGateSigmas * noise(z);
}

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

// The mean of the block's depths near its median, 0 when less than half of the block has a depth.
float block_depth(const Frame& frame, const SensorNoise& noise, int column, int row,
                  int reduction) {
  float values[kMaxReduction * kMaxReduction];
  int count = 0;
  for_each_of_block(frame, column, row, reduction, [&](int, int, float z) {
    if (z > 0 && std::isfinite(z)) values[count++] = z;
  });
  if (2 * count < reduction * reduction) return 0;
  std::sort(values, values + count);
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

// The sums over a window's points, relative to its centre, metres. Value is a float, or one for
// each of several windows.
template <class Value>
struct Moments {
  Value sx{}, sy{}, sz{}, xx{}, xy{}, xz{}, yy{}, yz{}, zz{}, count{};

  void add(const Value& x, const Value& y, const Value& z) {
    sx += x, sy += y, sz += z;
    xx += x * x, xy += x * y, xz += x * z;
    yy += y * y, yz += y * z, zz += z * z;
  }
};

// The normal of the plane fitted to a window's points; zero with fewer than kMinNormalPoints.
Eigen::Vector3f normal_of(const Moments<float>& m, const Eigen::Vector3f& centre) {
  if (m.count < kMinNormalPoints) return Eigen::Vector3f::Zero();
  const float n = 1.0f / m.count;
  Eigen::Matrix3f scatter;
  scatter << m.xx - m.sx * m.sx * n, m.xy - m.sx * m.sy * n, m.xz - m.sx * m.sz * n,  //
      m.xy - m.sx * m.sy * n, m.yy - m.sy * m.sy * n, m.yz - m.sy * m.sz * n,         //
      m.xz - m.sx * m.sz * n, m.yz - m.sy * m.sz * n, m.zz - m.sz * m.sz * n;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(scatter / scatter.trace());
  Eigen::Vector3f normal = solver.eigenvectors().col(0);
  if (!normal.allFinite()) return Eigen::Vector3f::Zero();
  if (normal.dot(centre) > 0) normal = -normal;
  return normal.normalized();
}

// A window of the depth image: pixels that far from its centre, every `step`-th of them.
struct Window {
  int radius, step;

  explicit Window(int pixels) : radius(pixels), step(pixels > kDenseWindow ? 2 : 1) {}
};

// How far depths of the window's pixels on one surface may be apart, metres.
float window_gate(const SurfaceMap& map, std::size_t centre, const Window& window) {
  return same_surface_gate(map.noise, map.depth[centre]) +
         kGatePerPixel * static_cast<float>(window.radius);
}

// Of the neighbours that lie on the same surface. The window may leave the image.
Moments<float> window_moments(const SurfaceMap& map, int u, int v, const Window& window) {
  const int width = map.width(), radius = window.radius;
  const int centre = v * width + u;
  const float gate = window_gate(map, centre, window);
  Moments<float> out;
  for (int y = std::max(0, v - radius); y <= std::min(map.height() - 1, v + radius);
       y += window.step) {
    for (int x = std::max(0, u - radius); x <= std::min(width - 1, u + radius); x += window.step) {
      const int index = y * width + x;
      if (map.depth[index] <= 0 || std::abs(map.depth[index] - map.depth[centre]) > gate) continue;
      const Eigen::Vector3f d = map.points[index] - map.points[centre];
      out.add(d.x(), d.y(), d.z());
      ++out.count;
    }
  }
  return out;
}

// Eight windows at a time, of neighbouring pixels.
constexpr int kLanes = 8;
using Lanes = float __attribute__((vector_size(sizeof(float) * kLanes)));

// The map's points as three images.
struct Coordinates {
  std::vector<float> x, y, z;

  explicit Coordinates(const SurfaceMap& map) {
    for (auto* image : {&x, &y, &z}) image->reserve(map.size());
    for (const Eigen::Vector3f& point : map.points) {
      x.push_back(point.x()), y.push_back(point.y()), z.push_back(point.z());
    }
  }
};

// The windows of the pixels from `centre` on, each with its gate. Inside the image. The same sums
// in the same order as window_moments().
BPA_DISPATCH void add_windows(const Coordinates& points, const float* depth, int width, int centre,
                              const Window& window, const Lanes& gate, Moments<Lanes>& out) {
  const auto load = [](const float* values, Lanes& lanes) {
    std::memcpy(&lanes, values, sizeof lanes);
  };
  const float *const px = points.x.data(), *const py = points.y.data(), *const pz = points.z.data();
  Lanes x0, y0, z0, depth0;
  load(px + centre, x0), load(py + centre, y0), load(pz + centre, z0);
  load(depth + centre, depth0);
  const Lanes limit = gate, none{}, one = none + 1;
  Moments<Lanes> sums;
  for (int row = -window.radius; row <= window.radius; row += window.step) {
    const int first = centre + row * width;
    for (int i = first - window.radius; i <= first + window.radius; i += window.step) {
      Lanes x, y, z, there;
      load(px + i, x), load(py + i, y), load(pz + i, z);
      load(depth + i, there);
      const Lanes apart = there - depth0;
      const auto near = (there > none) & (apart <= limit) & (apart >= -limit);
      sums.add(near ? x - x0 : none, near ? y - y0 : none, near ? z - z0 : none);
      sums.count += near ? one : none;
    }
  }
  out = sums;
}

// One row of normals.
class NormalRow {
 public:
  NormalRow(SurfaceMap& map, const Coordinates& points, double radius_m, int v)
      : map_(map), points_(points), pixels_at_1m_(radius_m * map.camera.fx), v_(v) {}

  void fit() {
    for (int u = 0; u < map_.width();) {
      const bool inside = u >= kMaxWindow && u + kLanes + kMaxWindow <= map_.width() &&
                          v_ >= kMaxWindow && v_ + kMaxWindow < map_.height();
      if (inside) {
        fit_lanes(u);
        u += kLanes;
      } else {
        if (known(u)) set(u, window_moments(map_, u, v_, Window(radius(u))));
        ++u;
      }
    }
  }

 private:
  std::size_t index(int u) const { return static_cast<std::size_t>(v_ * map_.width() + u); }
  bool known(int u) const { return map_.depth[index(u)] > 0; }
  int radius(int u) const {
    const double pixels = pixels_at_1m_ / static_cast<double>(map_.depth[index(u)]);
    return std::clamp(static_cast<int>(std::lround(pixels)), kMinWindow, kMaxWindow);
  }
  void set(int u, const Moments<float>& moments) {
    map_.normals[index(u)] = normal_of(moments, map_.points[index(u)]);
  }

  // Once for each radius that the pixels have.
  void fit_lanes(int u) {
    int radii[kLanes];
    for (int k = 0; k < kLanes; ++k) radii[k] = known(u + k) ? radius(u + k) : 0;
    const int largest = *std::max_element(radii, radii + kLanes);
    for (int r = largest; r >= kMinWindow; --r) {
      if (std::count(radii, radii + kLanes, r) == 0) continue;
      const Window window(r);
      Lanes gate;
      for (int k = 0; k < kLanes; ++k) gate[k] = window_gate(map_, index(u + k), window);
      Moments<Lanes> m;
      add_windows(points_, map_.depth.data(), map_.width(), static_cast<int>(index(u)), window,
                  gate, m);
      for (int k = 0; k < kLanes; ++k) {
        if (radii[k] != r) continue;
        set(u + k, {m.sx[k], m.sy[k], m.sz[k], m.xx[k], m.xy[k], m.xz[k], m.yy[k], m.yz[k], m.zz[k],
                    m.count[k]});
      }
    }
  }

  SurfaceMap& map_;
  const Coordinates& points_;
  double pixels_at_1m_;
  int v_;
};

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
  const Coordinates points(map);
  parallel_for(map.height(), options.num_threads,
               [&](int v) { NormalRow(map, points, options.normal_radius_m, v).fit(); });
  return map;
}

}  // namespace bpa
