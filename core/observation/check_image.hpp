// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/cloud/surface_map.hpp"

namespace bpa {

/// What a pose check reads of one pixel, packed so that a whole image stays in the cache.
struct CheckPixel {
  float depth = 0;                    ///< 0 where there is none.
  std::int8_t normal[3] = {0, 0, 0};  ///< Times 127; zero where unknown.
  std::uint8_t searched = 0;
};

/// The observed surface in the form that pose checks read.
struct CheckImage {
  int width = 0;
  int height = 0;
  float fx = 0, fy = 0, cx = 0, cy = 0;
  std::vector<CheckPixel> pixels;
};

CheckImage make_check_image(const SurfaceMap& map);

}  // namespace bpa
