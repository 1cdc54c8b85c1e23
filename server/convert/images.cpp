// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/convert/images.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <sstream>

#include "core/cloud/frame.hpp"
#include "core/geometry/distortion.hpp"

namespace bpa::server {
namespace {

static_assert(std::endian::native == std::endian::little, "pixels are copied as they lie");

constexpr std::uint32_t kMaxSide = 8192;

Status check_layout(const ImageView& image, std::size_t pixel_bytes) {
  std::ostringstream text;
  if (image.width == 0 || image.height == 0 || image.width > kMaxSide || image.height > kMaxSide) {
    text << image.field << " image is " << image.width << "x" << image.height
         << "; each side must be between 1 and " << kMaxSide;
    return invalid_argument(text.str());
  }
  const std::size_t row = image.width * pixel_bytes;
  const std::size_t step = image.step > 0 ? image.step : row;
  if (step < row) {
    text << image.field << " step is " << step << "; it must be at least " << row << " ("
         << image.width << " pixels of " << image.encoding << ")";
    return invalid_argument(text.str());
  }
  const std::size_t needed = step * image.height;
  if (image.size == needed) return {};
  text << image.field << " data has " << image.size << " bytes; it must have " << needed << " ("
       << image.height << " rows of " << step << " for " << image.width << "x" << image.height
       << " " << image.encoding << ")";
  return invalid_argument(text.str());
}

const std::uint8_t* row_of(const ImageView& image, std::size_t row, std::size_t pixel_bytes) {
  return image.data + row * (image.step > 0 ? image.step : image.width * pixel_bytes);
}

template <class Raw, bool kSwap>
Raw read(const std::uint8_t* bytes) {
  Raw value;
  if constexpr (kSwap) {
    std::uint8_t copy[sizeof(Raw)];
    for (std::size_t i = 0; i < sizeof(Raw); ++i) copy[i] = bytes[sizeof(Raw) - 1 - i];
    std::memcpy(&value, copy, sizeof(Raw));
  } else {
    std::memcpy(&value, bytes, sizeof(Raw));
  }
  return value;
}

template <class Raw, bool kSwap, class ToMetres>
void read_rows(const ImageView& image, ToMetres to_metres, std::vector<float>& depth) {
  depth.reserve(std::size_t{image.width} * image.height);
  for (std::size_t v = 0; v < image.height; ++v) {
    const std::uint8_t* row = row_of(image, v, sizeof(Raw));
    depth.resize((v + 1) * image.width);  // row by row: what resize writes is still in the cache
    float* out = depth.data() + v * image.width;
    for (std::size_t u = 0; u < image.width; ++u) {
      out[u] = to_metres(read<Raw, kSwap>(row + u * sizeof(Raw)));
    }
  }
}

template <class Raw, class ToMetres>
Result<std::vector<float>> read_depth(const ImageView& image, ToMetres to_metres) {
  if (Status status = check_layout(image, sizeof(Raw)); !status.ok()) return status;
  std::vector<float> depth;
  if (image.big_endian) {
    read_rows<Raw, true>(image, to_metres, depth);
  } else {
    read_rows<Raw, false>(image, to_metres, depth);
  }
  return depth;
}

struct ColorLayout {
  const char* encoding;
  std::size_t bytes;
  std::size_t red, green, blue;  ///< Offsets in a pixel.

  bool is_rgb() const { return bytes == 3 && red == 0 && blue == 2; }
};

constexpr ColorLayout kColorLayouts[] = {{"rgb8", 3, 0, 1, 2},
                                         {"bgr8", 3, 2, 1, 0},
                                         {"rgba8", 4, 0, 1, 2},
                                         {"bgra8", 4, 2, 1, 0},
                                         {"mono8", 1, 0, 0, 0}};

}  // namespace

Result<std::vector<float>> depth_from_image(const ImageView& image) {
  if (image.encoding == "16UC1" || image.encoding == "mono16") {
    return read_depth<std::uint16_t>(
        image, [](std::uint16_t mm) { return static_cast<float>(mm * 0.001); });
  }
  if (image.encoding == "32FC1") {
    return read_depth<float>(image, [](float z) { return z > 0 && std::isfinite(z) ? z : 0.0f; });
  }
  return Status(StatusCode::unsupported, std::string(image.field) + " encoding is \"" +
                                             image.encoding +
                                             "\"; it must be 16UC1 (mm) or 32FC1 (m)");
}

Result<std::vector<std::uint8_t>> color_from_image(const ImageView& image) {
  for (const ColorLayout& layout : kColorLayouts) {
    if (image.encoding != layout.encoding) continue;
    if (Status status = check_layout(image, layout.bytes); !status.ok()) return status;
    const std::size_t row_bytes = std::size_t{3} * image.width;
    if (layout.is_rgb() && (image.step == 0 || image.step == row_bytes)) {
      return std::vector<std::uint8_t>(image.data, image.data + image.size);
    }
    std::vector<std::uint8_t> rgb(row_bytes * image.height);
    std::uint8_t* out = rgb.data();
    for (std::size_t v = 0; v < image.height; ++v) {
      const std::uint8_t* pixel = row_of(image, v, layout.bytes);
      for (std::size_t u = 0; u < image.width; ++u, pixel += layout.bytes) {
        *out++ = pixel[layout.red];
        *out++ = pixel[layout.green];
        *out++ = pixel[layout.blue];
      }
    }
    return rgb;
  }
  return Status(StatusCode::unsupported, std::string(image.field) + " encoding is \"" +
                                             image.encoding +
                                             "\"; it must be rgb8, bgr8, rgba8, bgra8 or mono8");
}

std::vector<std::int32_t> undistortion_map(const Camera& camera,
                                           const std::vector<double>& distortion) {
  std::vector<std::int32_t> map;
  map.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2d bent =
          distort(distortion, (u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
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

}  // namespace bpa::server
