// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/image_edges.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/cloud/blur.hpp"

namespace bpa {

Image<std::uint8_t> image_edges(const Image<Eigen::Vector3f>& rgb,
                                const ImageEdgeOptions& options) {
  Image<std::uint8_t> edges(rgb.width, rgb.height, 0);
  if (rgb.empty()) return edges;
  Image<float> luminance(rgb.width, rgb.height, 0);
  const Eigen::Vector3f weights(0.299f, 0.587f, 0.114f);  // ITU-R BT.601
  for (std::size_t i = 0; i < rgb.size(); ++i) luminance[i] = weights.dot(rgb[i]);
  luminance = blur(luminance, options.blur_px, options.num_threads);
  Image<std::uint8_t> rounded(rgb.width, rgb.height, 0);
  for (std::size_t i = 0; i < rounded.size(); ++i) {
    rounded[i] = static_cast<std::uint8_t>(std::clamp(luminance[i] + 0.5f, 0.0f, 255.0f));
  }
  const cv::Mat in(rgb.height, rgb.width, CV_8U, rounded.pixels.data());
  cv::Mat out(rgb.height, rgb.width, CV_8U, edges.pixels.data());
  // A step of height h has a Sobel gradient of 4 h.
  cv::Canny(in, out, 4 * std::min(options.low, options.high), 4 * options.high, 3, true);
  for (std::uint8_t& value : edges.pixels) value = value != 0;
  return edges;
}

}  // namespace bpa
