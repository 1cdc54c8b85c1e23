// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/blur.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/dispatch.hpp"
#include "core/base/parallel.hpp"

namespace bpa {
namespace {

constexpr int kRowsPerPiece = 16;

// Weights -r..r, summing to one.
std::vector<float> gaussian(double sigma) {
  const int radius = std::max(1, static_cast<int>(std::ceil(3 * sigma)));
  std::vector<float> weights;
  float sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    weights.push_back(static_cast<float>(std::exp(-0.5 * k * k / (sigma * sigma))));
    sum += weights.back();
  }
  for (float& weight : weights) weight /= sum;
  return weights;
}

// Runs over plain rows of floats, so that the compiler can use wide vectors.
BPA_DISPATCH void add_row(const float* __restrict from, float weight, int count,
                          float* __restrict to) {
  for (int j = 0; j < count; ++j) to[j] += weight * from[j];
}

// `channels` neighbouring floats belong to one pixel.
void blur(const float* in, int width, int height, int channels, const std::vector<float>& weights,
          int num_threads, float* out) {
  const int row = width * channels;
  const int radius = static_cast<int>(weights.size() / 2), margin = radius * channels;
  std::vector<float> between(row * height, 0.0f);
  parallel_for_pieces(height, kRowsPerPiece, num_threads, [&](int first, int last, int) {
    std::vector<float> padded(row + 2 * margin);
    for (int v = first; v < last; ++v) {
      const float* const from = in + v * row;
      std::copy(from, from + row, padded.begin() + margin);
      for (int j = 0; j < margin; ++j) {
        padded[j] = from[j % channels];
        padded[margin + row + j] = from[row - channels + j % channels];
      }
      for (int k = 0; k <= 2 * radius; ++k) {
        add_row(padded.data() + k * channels, weights[k], row, between.data() + v * row);
      }
    }
  });
  parallel_for(height, num_threads, [&](int v) {
    for (int k = -radius; k <= radius; ++k) {
      const int from = std::clamp(v + k, 0, height - 1);
      add_row(between.data() + from * row, weights[k + radius], row, out + v * row);
    }
  });
}

}  // namespace

Image<float> blur(const Image<float>& image, double sigma, int num_threads) {
  if (!(sigma > 0) || image.empty()) return image;
  Image<float> out(image.width, image.height, 0);
  blur(image.pixels.data(), image.width, image.height, 1, gaussian(sigma), num_threads,
       out.pixels.data());
  return out;
}

Image<Eigen::Vector3f> blur(const Image<Eigen::Vector3f>& image, double sigma, int num_threads) {
  if (!(sigma > 0) || image.empty()) return image;
  Image<Eigen::Vector3f> out(image.width, image.height, Eigen::Vector3f::Zero());
  blur(image.pixels.data()->data(), image.width, image.height, 3, gaussian(sigma), num_threads,
       out.pixels.data()->data());
  return out;
}

float blurred_line_peak(double sigma) {
  if (!(sigma > 0)) return 1;
  const std::vector<float> weights = gaussian(sigma);
  return weights[weights.size() / 2];
}

}  // namespace bpa
