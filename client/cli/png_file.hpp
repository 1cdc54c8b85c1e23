// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <bpa/status.hpp>

namespace bpa::cli {

/// Pixels of a PNG file, row-major.
struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> pixels;
};

/// Any PNG as 8-bit rgb. Fails with not_found or corrupt.
Result<RgbImage> read_color_png(const std::string& path);
/// A 16-bit grey PNG. Fails with not_found, corrupt, or invalid_argument for another kind.
Result<DepthImage> read_depth_png(const std::string& path);
/// A 16-bit grey PNG of width x height pixels; fast rather than small.
Status write_depth_png(const std::string& path, int width, int height,
                       const std::vector<std::uint16_t>& pixels);
/// `rgb` holds 3 x width x height bytes.
Status write_png(const std::string& path, int width, int height,
                 const std::vector<std::uint8_t>& rgb, bool fast = false);

}  // namespace bpa::cli
