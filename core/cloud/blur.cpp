// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/blur.hpp"

#include <algorithm>
#include <cmath>

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

// Both passes run over plain rows of floats, so that the compiler can use wide vectors; `channels`
// neighbouring floats belong to one pixel.
struct Blur {
  int width, height, channels;
  std::vector<float> weights;

  int row_size() const { return width * channels; }
  int radius() const { return static_cast<int>(weights.size() / 2); }

  void add_row(const float* from, float weight, float* to) const {
    const int count = row_size();
    for (int j = 0; j < count; ++j) to[j] += weight * from[j];
  }
  void across(const float* in, float* out, std::vector<float>& padded) const {
    const int margin = radius() * channels;
    padded.resize(static_cast<std::size_t>(row_size() + 2 * margin));
    for (int j = 0; j < margin; ++j) {
      padded[static_cast<std::size_t>(j)] = in[j % channels];
      padded[static_cast<std::size_t>(margin + row_size() + j)] =
          in[row_size() - channels + j % channels];
    }
    std::copy(in, in + row_size(), padded.begin() + margin);
    std::fill(out, out + row_size(), 0.0f);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      add_row(padded.data() + static_cast<int>(k) * channels, weights[k], out);
    }
  }
  void down(const float* in, int row, float* out) const {
    std::fill(out, out + row_size(), 0.0f);
    for (int k = -radius(); k <= radius(); ++k) {
      const int from = std::clamp(row + k, 0, height - 1);
      add_row(in + from * row_size(), weights[static_cast<std::size_t>(k + radius())], out);
    }
  }
};

void run(const Blur& blur, const float* in, float* out, int num_threads) {
  std::vector<float> between(static_cast<std::size_t>(blur.row_size() * blur.height));
  parallel_for_pieces(blur.height, kRowsPerPiece, num_threads, [&](int first, int last, int) {
    std::vector<float> padded;
    for (int v = first; v < last; ++v) {
      blur.across(in + v * blur.row_size(), between.data() + v * blur.row_size(), padded);
    }
  });
  parallel_for(
      blur.height, num_threads,
      [&](int v) { blur.down(between.data(), v, out + v * blur.row_size()); }, kRowsPerPiece);
}

}  // namespace

Image<float> blur(const Image<float>& image, double sigma, int num_threads) {
  if (!(sigma > 0) || image.empty()) return image;
  Image<float> out(image.width, image.height, 0);
  run({image.width, image.height, 1, gaussian(sigma)}, image.pixels.data(), out.pixels.data(),
      num_threads);
  return out;
}

Image<Eigen::Vector3f> blur(const Image<Eigen::Vector3f>& image, double sigma, int num_threads) {
  if (!(sigma > 0) || image.empty()) return image;
  Image<Eigen::Vector3f> out(image.width, image.height, Eigen::Vector3f::Zero());
  run({image.width, image.height, 3, gaussian(sigma)}, image.pixels.data()->data(),
      out.pixels.data()->data(), num_threads);
  return out;
}

float blurred_line_peak(double sigma) {
  if (!(sigma > 0)) return 1;
  const std::vector<float> weights = gaussian(sigma);
  return weights[weights.size() / 2];
}

}  // namespace bpa
