// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "ros/images.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <type_traits>

#include <opencv2/imgproc.hpp>

#include "core/base/concat.hpp"
#include "core/cloud/frame.hpp"
#include "core/io/image_file.hpp"

namespace bpa::ros {
namespace {

static_assert(std::endian::native == std::endian::little, "pixels are copied as they lie");

/// The bytes from row to row, once it is known that all rows are there.
Result<std::size_t> checked_step(const ImageView& image, std::size_t pixel_bytes) {
  const Status status = check_size(std::string(image.field) + " image", image.width, image.height);
  if (!status.ok()) return status;
  const std::size_t row = image.width * pixel_bytes;
  const std::size_t step = image.step > 0 ? image.step : row;
  if (step < row) {
    return invalid_argument(image.field, " step is ", step, "; it must be at least ", row, " (",
                            image.width, " pixels of ", image.encoding, ")");
  }
  const std::size_t needed = step * image.height;
  if (image.size == needed) return step;
  return invalid_argument(image.field, " data has ", image.size, " bytes; it must have ", needed,
                          " (", image.height, " rows of ", step, " for ", image.width, "x",
                          image.height, " ", image.encoding, ")");
}

template <class Raw>
Raw read(const std::uint8_t* bytes, bool swap) {
  std::array<std::uint8_t, sizeof(Raw)> copy;
  std::copy_n(bytes, sizeof(Raw), copy.begin());
  if (swap) std::reverse(copy.begin(), copy.end());
  return std::bit_cast<Raw>(copy);
}

/// Of an image of one channel.
template <class Raw, class Convert, class Pixel = std::invoke_result_t<Convert, Raw>>
Result<std::vector<Pixel>> read_pixels(const ImageView& image, Convert convert) {
  const Result<std::size_t> step = checked_step(image, sizeof(Raw));
  if (!step.ok()) return step.status();
  std::vector<Pixel> pixels;
  pixels.reserve(std::size_t{image.width} * image.height);
  for (std::size_t v = 0; v < image.height; ++v) {
    const std::uint8_t* row = image.data + v * *step;
    pixels.resize((v + 1) * image.width);  // row by row: what resize writes is still in the cache
    Pixel* out = pixels.data() + v * image.width;
    for (std::size_t u = 0; u < image.width; ++u) {
      out[u] = convert(read<Raw>(row + u * sizeof(Raw), image.big_endian));
    }
  }
  return pixels;
}

struct ColorLayout {
  const char* encoding;
  int type;
  int to_rgb;  ///< cv::cvtColor's code; below 0: it is rgb.
};

constexpr ColorLayout kColorLayouts[] = {{"rgb8", CV_8UC3, -1},
                                         {"bgr8", CV_8UC3, cv::COLOR_BGR2RGB},
                                         {"rgba8", CV_8UC4, cv::COLOR_RGBA2RGB},
                                         {"bgra8", CV_8UC4, cv::COLOR_BGRA2RGB},
                                         {"mono8", CV_8UC1, cv::COLOR_GRAY2RGB}};

}  // namespace

Status check_size(const std::string& what, std::uint32_t width, std::uint32_t height) {
  constexpr std::uint32_t kMaxSide = io::kMaxImageSide;
  if (width > 0 && height > 0 && width <= kMaxSide && height <= kMaxSide) return {};
  return invalid_argument(what, " is ", width, "x", height, "; each side must be between 1 and ",
                          kMaxSide);
}

Result<std::vector<float>> depth_from_image(const ImageView& image) {
  if (image.encoding == "16UC1" || image.encoding == "mono16") {
    return read_pixels<std::uint16_t>(
        image, [](std::uint16_t mm) { return static_cast<float>(mm * 0.001); });
  }
  if (image.encoding == "32FC1") {
    return read_pixels<float>(image, [](float z) { return z > 0 && std::isfinite(z) ? z : 0.0f; });
  }
  return Status(StatusCode::unsupported, concat(image.field, " encoding is \"", image.encoding,
                                                "\"; it must be 16UC1 (mm) or 32FC1 (m)"));
}

Result<std::vector<std::uint8_t>> color_from_image(const ImageView& image) {
  if (image.encoding == "mono16") {
    const auto grey = read_pixels<std::uint16_t>(image, [](std::uint16_t value) { return value; });
    if (!grey.ok()) return grey.status();
    return io::rgb_of_grey(*grey);
  }
  for (const ColorLayout& layout : kColorLayouts) {
    if (image.encoding != layout.encoding) continue;
    const Result<std::size_t> step = checked_step(image, CV_ELEM_SIZE(layout.type));
    if (!step.ok()) return step.status();
    const cv::Size size(static_cast<int>(image.width), static_cast<int>(image.height));
    const cv::Mat pixels(size, layout.type, const_cast<std::uint8_t*>(image.data), *step);
    std::vector<std::uint8_t> rgb(std::size_t{3} * image.width * image.height);
    cv::Mat out(size, CV_8UC3, rgb.data());
    if (layout.to_rgb < 0) {
      pixels.copyTo(out);
    } else {
      cv::cvtColor(pixels, out, layout.to_rgb);
    }
    return rgb;
  }
  return Status(StatusCode::unsupported,
                concat(image.field, " encoding is \"", image.encoding,
                       "\"; it must be rgb8, bgr8, rgba8, bgra8, mono8 or mono16"));
}

}  // namespace bpa::ros
