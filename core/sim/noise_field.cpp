// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/noise_field.hpp"

#include <cmath>
#include <cstddef>

#include "core/base/parallel.hpp"
#include "core/base/random.hpp"

namespace bpa::sim {
namespace {

// A tent whose squares sum to 1, so that variances stay 1.
std::vector<float> tent(int radius) {
  std::vector<float> weights;
  double squares = 0;
  for (int i = -radius; i <= radius; ++i) {
    const double w = radius + 1 - std::abs(i);
    weights.push_back(static_cast<float>(w));
    squares += w * w;
  }
  for (float& w : weights) w /= static_cast<float>(std::sqrt(squares));
  return weights;
}

}  // namespace

std::vector<float> noise_field(int width, int height, int radius, std::uint64_t seed,
                               int num_threads) {
  const std::vector<float> weights = tent(radius);
  const int taps = static_cast<int>(weights.size());
  const int padded_height = height + 2 * radius;
  const std::size_t row = static_cast<std::size_t>(width);
  // White noise, smoothed along its rows as it is made.
  std::vector<float> smooth_rows(row * padded_height);
  parallel_for(
      padded_height, num_threads,
      [&](int y) {
        RandomStream random(seed, static_cast<std::uint64_t>(y));
        std::vector<float> white(row + 2 * radius);
        for (float& value : white) value = static_cast<float>(random.normal());
        for (int x = 0; x < width; ++x) {
          float sum = 0;
          for (int k = 0; k < taps; ++k) sum += weights[k] * white[x + k];
          smooth_rows[y * row + x] = sum;
        }
      },
      16);
  if (radius == 0) return smooth_rows;
  std::vector<float> field(row * height, 0.0f);
  parallel_for(
      height, num_threads,
      [&](int y) {
        for (int k = 0; k < taps; ++k) {
          for (int x = 0; x < width; ++x) {
            field[y * row + x] += weights[k] * smooth_rows[(y + k) * row + x];
          }
        }
      },
      16);
  return field;
}

}  // namespace bpa::sim
