// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/observation/flat_regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/tolerance.hpp"
#include "core/model/flat_rest.hpp"

namespace bpa {
namespace {

// Chosen by hand on simulated tables, as all constants of this file.
constexpr float kLow = 0.03f;         // metres above the plane: as high as thin objects are
constexpr float kLightWeight = 0.5f;  // of lightness: uneven light differs in it
constexpr int kShadow = 2;            // cells: what is this much darker may be a shadow
constexpr float kColorCell = 4;       // CIELAB
constexpr float kRare = 0.02f;        // share of the plane's pixels; a cloth's colours are more
constexpr int kFewestOnPlane = 500;   // pixels whose colours are the plane's
constexpr std::size_t kFewestPixels = 12;
constexpr float kSmallest = 3e-4f, kLargest = 4e-2f;  // square metres
constexpr float kMostRising = 0.25f;                  // share of the border that goes on upward
constexpr std::size_t kMostRegions = 40;

bool on_background(const SurfaceMap& map, const Plane& plane, std::size_t i) {
  return map.depth[i] > 0 && !map.searched[i] &&
         std::abs(plane.height(map.points[i])) < tolerance::kGoesOn(map.noise(map.depth[i]));
}

// How often each colour is seen on a plane.
class ColorCounts {
 public:
  void add(const Eigen::Vector3f& lab) {
    ++counts_[index(cell(lab))];
    ++all_;
  }
  bool enough() const { return all_ >= kFewestOnPlane; }
  // True where few pixels of the plane have about this colour.
  bool rare(const Eigen::Vector3f& lab) const {
    const Eigen::Vector3i at = cell(lab);
    int near = 0;
    for (int l = -1; l <= kShadow; ++l) {
      for (int a = -1; a <= 1; ++a) {
        for (int b = -1; b <= 1; ++b) near += counts_[index(at + Eigen::Vector3i(l, a, b))];
      }
    }
    return static_cast<float>(near) < kRare * static_cast<float>(all_);
  }

 private:
  static constexpr int kCells = 68;  // 64 x 4 covers a and b from -128 to 128
  static Eigen::Vector3i cell(const Eigen::Vector3f& lab) {
    const Eigen::Vector3f from_zero(kLightWeight * lab[0], lab[1] + 128, lab[2] + 128);
    return (from_zero / kColorCell)
               .array()
               .floor()
               .cast<int>()
               .cwiseMax(0)
               .cwiseMin(kCells - 2 - kShadow) +
           1;
  }
  static std::size_t index(const Eigen::Vector3i& at) {
    return static_cast<std::size_t>((at[0] * kCells + at[1]) * kCells + at[2]);
  }

  std::vector<int> counts_ = std::vector<int>(kCells * kCells * kCells, 0);
  int all_ = 0;
};

// 1 where a pixel of the plane has a colour that is rare on it, or surface is a little above it.
Image<std::uint8_t> different(const SurfaceMap& map, const Plane& plane,
                              const Image<Eigen::Vector3f>& cielab) {
  ColorCounts colors;
  for (std::size_t i = 0; i < cielab.size(); ++i) {
    if (on_background(map, plane, i)) colors.add(cielab[i]);
  }
  Image<std::uint8_t> mask(map.width(), map.height(), 0);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!(map.depth[i] > 0)) continue;
    const float height = plane.height(map.points[i]);
    mask[i] = (map.searched[i] && height > 0 && height < kLow) ||
              (colors.enough() && on_background(map, plane, i) && colors.rare(cielab[i]));
  }
  return mask;
}

std::array<std::pair<int, int>, 8> neighbours(int u, int v) {
  return {{{u + 1, v},
           {u - 1, v},
           {u, v + 1},
           {u, v - 1},
           {u + 1, v + 1},
           {u - 1, v - 1},
           {u + 1, v - 1},
           {u - 1, v + 1}}};
}

// The pixels connected with `first`, by their eight neighbours; clears them.
std::vector<std::uint32_t> take_connected(Image<std::uint8_t>& mask, std::uint32_t first) {
  std::vector<std::uint32_t> pixels{first};
  mask[first] = 0;
  for (std::size_t next = 0; next < pixels.size(); ++next) {
    const int at = static_cast<int>(pixels[next]);
    for (const auto& [x, y] : neighbours(at % mask.width, at / mask.width)) {
      if (!mask.contains(x, y) || !mask.at(x, y)) continue;
      mask.at(x, y) = 0;
      pixels.push_back(static_cast<std::uint32_t>(mask.index(x, y)));
    }
  }
  return pixels;
}

// The share of a region's border beyond which its surface goes on upward, over kLow.
float rising_share(const SurfaceMap& map, const Plane& plane, const Image<std::uint8_t>& mask,
                   const std::vector<std::uint32_t>& pixels) {
  int border = 0, rising = 0;
  for (const std::uint32_t pixel : pixels) {
    const int at = static_cast<int>(pixel);
    for (const auto& [x, y] : neighbours(at % mask.width, at / mask.width)) {
      if (!mask.contains(x, y) || mask.at(x, y)) continue;
      const std::size_t beyond = mask.index(x, y);
      ++border;
      rising += map.searched[beyond] && plane.height(map.points[beyond]) >= kLow &&
                !surface_breaks(map, pixel, beyond);
    }
  }
  return static_cast<float>(rising) / static_cast<float>(std::max(1, border));
}

struct Found {
  float area = 0;  // square metres
  FlatRegion region;
  std::vector<std::uint32_t> pixels;
};

Found measured(const SurfaceMap& map, const Plane& plane, std::vector<std::uint32_t> pixels) {
  Found found;
  std::vector<Eigen::Vector3f> points;
  for (const std::uint32_t pixel : pixels) {
    const Eigen::Vector3f& p = map.points[pixel];
    points.push_back(p - plane.normal * plane.height(p));
    const auto side = static_cast<float>(static_cast<double>(p.z()) / map.camera.fx);
    constexpr float kMinSlant = 0.2f;  // cosine
    found.area += side * side / std::max(kMinSlant, -plane.normal.dot(p) / p.norm());
  }
  const FlatExtent extent = flat_extent(points, plane.normal);
  found.region = {plane.normal,  extent.middle, extent.axis,
                  extent.length, extent.width,  static_cast<int>(pixels.size())};
  found.pixels = std::move(pixels);
  return found;
}

void add_regions(const SurfaceMap& map, const Plane& plane, const Image<std::uint8_t>& mask,
                 std::vector<Found>& all) {
  Image<std::uint8_t> left = mask;
  for (std::uint32_t i = 0; i < left.size(); ++i) {
    if (!left[i]) continue;
    std::vector<std::uint32_t> pixels = take_connected(left, i);
    if (pixels.size() < kFewestPixels) continue;
    if (rising_share(map, plane, mask, pixels) > kMostRising) continue;
    Found found = measured(map, plane, std::move(pixels));
    if (found.area > kSmallest && found.area < kLargest) all.push_back(std::move(found));
  }
}

}  // namespace

FlatRegions find_flat_regions(const SurfaceMap& map, std::span<const Plane> planes,
                              const Image<Eigen::Vector3f>& cielab) {
  std::vector<Found> all;
  for (const Plane& plane : planes) {
    add_regions(map, plane, different(map, plane, cielab), all);
  }
  std::ranges::stable_sort(all, std::greater(), &Found::area);
  if (all.size() > kMostRegions) all.resize(kMostRegions);
  FlatRegions out{{}, {map.width(), map.height(), -1}};
  for (const Found& found : all) {
    for (const std::uint32_t pixel : found.pixels) {
      out.label[pixel] = static_cast<std::int16_t>(out.regions.size());
    }
    out.regions.push_back(found.region);
  }
  return out;
}

}  // namespace bpa
