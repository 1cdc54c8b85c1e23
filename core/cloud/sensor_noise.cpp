// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/sensor_noise.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace bpa {
namespace {

// Chosen by hand, as all numbers of this file.
constexpr int kBeside = 1, kApart = 5;     // pixels between points that are compared
constexpr std::size_t kFewestSizes = 500;  // second differences; fewer tell no noise

// Depth is given in millimetres or tenths of them; rendered and averaged depth is not.
bool in_whole_units(const std::vector<float>& depth) {
  constexpr float kUnitsPerMetre = 1e4f, kOff = 0.02f;  // rounding of floats is under 0.01 units
  constexpr std::size_t kStep = 7;
  int whole = 0, seen = 0;
  for (std::size_t i = 0; i < depth.size(); i += kStep) {
    if (!(depth[i] > 0)) continue;  // or NaN
    const float units = depth[i] * kUnitsPerMetre;
    whole += std::abs(units - std::round(units)) < kOff;
    ++seen;
  }
  return seen > 0 && whole > 0.98 * seen;
}

// Second differences along the rows, of points `reach` pixels apart: the standard deviation
// of white noise that gives their smaller half.
double noise_at(const Frame& frame, int reach) {
  constexpr float kOneSurface = 0.02f;  // metres
  constexpr int kStep = 3;
  std::vector<float> sizes;
  for (int y = 0; y < frame.camera.height; y += kStep) {
    const float* row = frame.depth.data() + static_cast<std::size_t>(y) * frame.camera.width;
    for (int x = kApart; x + kApart < frame.camera.width; x += kStep) {
      const float here = row[x], left = row[x - kApart], right = row[x + kApart];
      if (!(here > 0 && left > 0 && right > 0)) continue;
      if (!(row[x - reach] > 0 && row[x + reach] > 0)) continue;
      if (!(std::abs(left - here) + std::abs(right - here) <= kOneSurface)) continue;
      sizes.push_back(std::abs(row[x - reach] - 2 * row[x] + row[x + reach]));
    }
  }
  if (sizes.size() < kFewestSizes) return 0;
  // A mean is steadier than the median of a few whole millimetres.
  const std::size_t half = sizes.size() / 2;
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(half), sizes.end());
  double sum = 0;
  for (std::size_t i = 0; i < half; ++i) sum += sizes[i];
  constexpr double kHalfMean = 0.3247;  // of the smaller half of normal sizes, standard deviations
  return sum / static_cast<double>(half) / (kHalfMean * std::sqrt(6.0));
}

}  // namespace

SensorTraits sensor_traits(const Frame& frame) {
  SensorTraits traits;
  traits.measured = frame.fused <= 1 && in_whole_units(frame.depth);
  if (!traits.measured) return traits;
  traits.noise = noise_at(frame, kApart);
  if (traits.noise > 0) traits.whiteness = noise_at(frame, kBeside) / traits.noise;
  return traits;
}

SensorKind sensor_kind_of(const SensorTraits& traits) {
  constexpr double kSteps = 0.22, kWhite = 0.6;  // whiteness
  constexpr double kNoise = 0.0005;              // metres; less is the rounding to millimetres
  if (!traits.measured || traits.whiteness < kSteps || traits.noise < kNoise) {
    return SensorKind::structured_light;
  }
  return traits.whiteness > kWhite ? SensorKind::time_of_flight : SensorKind::active_stereo;
}

}  // namespace bpa
