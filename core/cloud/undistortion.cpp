// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/undistortion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bpa {
namespace {

template <class Pixel, std::size_t kChannels>
void remap(const std::vector<std::int32_t>& map, std::vector<Pixel>& pixels) {
  if (pixels.empty()) return;
  std::vector<Pixel> out(pixels.size(), Pixel{});
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i] < 0) continue;
    std::copy_n(pixels.begin() + map[i] * kChannels, kChannels, out.begin() + i * kChannels);
  }
  pixels = std::move(out);
}

}  // namespace

std::vector<std::int32_t> undistortion_map(const Camera& camera, const Lens& lens) {
  std::vector<std::int32_t> map;
  map.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2d bent =
          distort(lens, (u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
      const double ud = std::round(bent.x() * camera.fx + camera.cx);
      const double vd = std::round(bent.y() * camera.fy + camera.cy);
      const bool inside = ud >= 0 && vd >= 0 && ud < camera.width && vd < camera.height;
      map.push_back(inside ? static_cast<std::int32_t>(vd) * camera.width +
                                 static_cast<std::int32_t>(ud)
                           : -1);
    }
  }
  return map;
}

void undistort(const Lens& lens, Frame& frame) {
  if (lens.coefficients.empty()) return;
  const std::vector<std::int32_t> map = undistortion_map(frame.camera, lens);
  remap<float, 1>(map, frame.depth);
  remap<std::uint8_t, 3>(map, frame.color);
}

}  // namespace bpa
