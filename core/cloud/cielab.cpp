// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/cielab.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"

namespace bpa {
namespace {

// CIE 15: a cube root with a straight foot.
double cielab_root(double value) {
  constexpr double kFoot = 216.0 / 24389.0;
  return value > kFoot ? std::cbrt(value) : (24389.0 / 27.0 * value + 16) / 116;
}

template <std::size_t N>
float interpolate(const std::array<float, N>& table, float position) {
  const int whole = static_cast<int>(position);  // to 64 bits without sign takes twice the time
  const float part = position - static_cast<float>(whole);
  const auto below = static_cast<std::size_t>(whole);
  return table[below] + part * (table[below + 1] - table[below]);
}

}  // namespace

double linear_of_srgb(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

double srgb_of_linear(double value) {
  return value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055;
}

Eigen::Array3f light_roots(const Eigen::Vector3f& lab) {
  constexpr float kDarkest = 0.1f;
  const float y = (lab[0] + 16) / 116;
  return Eigen::Array3f(y + lab[1] / 500, y, y - lab[2] / 200).max(kDarkest);
}

Eigen::Vector3f log_light(const Eigen::Vector3f& lab) {
  const Eigen::Array3f roots = light_roots(lab);
  const float green = std::log(roots[1]);
  return {green, std::log(roots[0]) - green, std::log(roots[2]) - green};
}

CielabConverter::CielabConverter() {
  for (std::size_t i = 0; i < linear_.size(); ++i) {
    const double value = std::min(255.0, static_cast<double>(i)) / 255;
    linear_[i] = static_cast<float>(linear_of_srgb(value));
  }
  for (std::size_t i = 0; i < lightness_.size(); ++i) {
    const double value = std::min(1.0, static_cast<double>(i) / kSteps);
    lightness_[i] = static_cast<float>(cielab_root(value));
  }
}

Eigen::Vector3f CielabConverter::operator()(const Eigen::Vector3f& rgb) const {
  const auto linear = [&](int k) { return interpolate(linear_, std::clamp(rgb[k], 0.0f, 255.0f)); };
  const float r = linear(0), g = linear(1), b = linear(2);
  // Relative to the white point, so that each is 1 for white.
  const float x = (0.4124564f * r + 0.3575761f * g + 0.1804375f * b) / 0.95047f;
  const float y = 0.2126729f * r + 0.7151522f * g + 0.0721750f * b;
  const float z = (0.0193339f * r + 0.1191920f * g + 0.9503041f * b) / 1.08883f;
  const auto root = [&](float value) {
    return interpolate(lightness_, std::min(value, 1.0f) * static_cast<float>(kSteps));
  };
  const float fx = root(x), fy = root(y), fz = root(z);
  return {116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)};
}

Image<Eigen::Vector3f> reduced_color(const Frame& frame, const SurfaceMap& map, int num_threads) {
  if (frame.color.empty()) return {};
  Image<Eigen::Vector3f> out(map.width(), map.height(), Eigen::Vector3f::Zero());
  const int reduction = map.reduction;
  const float share = 1.0f / static_cast<float>(reduction * reduction);
  parallel_for(out.height, num_threads, [&](int v) {
    for (int u = 0; u < out.width; ++u) {
      Eigen::Vector3i sum = Eigen::Vector3i::Zero();
      for (int y = v * reduction; y < (v + 1) * reduction; ++y) {
        const auto* pixel = &frame.color[3 * (y * frame.camera.width + u * reduction)];
        for (int x = 0; x < 3 * reduction; ++x) sum[x % 3] += pixel[x];
      }
      out.at(u, v) = share * sum.cast<float>();
    }
  });
  return out;
}

Image<Eigen::Vector3f> cielab(const Image<Eigen::Vector3f>& rgb, int num_threads) {
  Image<Eigen::Vector3f> out = rgb;
  const CielabConverter convert;
  parallel_for(out.size(), num_threads, [&](std::size_t i) { out[i] = convert(rgb[i]); });
  return out;
}

}  // namespace bpa
