// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/silhouette_score.hpp"

#include <algorithm>
#include <cmath>

#include "core/score/likelihood.hpp"

namespace bpa {
namespace {

// Chosen by hand on simulated piles, as all constants of this file.
constexpr float kBehind = 0.03f;    // metres: a step of depth within the object is an outline
constexpr int kFewestOutline = 12;  // pixels of the reduced image
// In pixels of the reduced image: where the outline is looked for, and where its surroundings are.
constexpr float kOutlineReach = 1.5f, kBesideFrom = 2.5f, kBesideTo = 4;

// The direction out of the object at one of its pixels; zero inside of it.
Eigen::Vector2f outward(const PredictedSurface& predicted, int u, int v, float z) {
  const auto outside = [&](int x, int y) {
    const float there = predicted.depth_at(x, y);
    return there <= 0 || there > z + kBehind;
  };
  if (!(outside(u + 1, v) || outside(u - 1, v) || outside(u, v + 1) || outside(u, v - 1))) {
    return Eigen::Vector2f::Zero();
  }
  Eigen::Vector2f sum = Eigen::Vector2f::Zero();
  for (int dv = -2; dv <= 2; ++dv) {
    for (int du = -2; du <= 2; ++du) {
      if (outside(u + du, v + dv)) {
        sum += Eigen::Vector2f(static_cast<float>(du), static_cast<float>(dv));
      }
    }
  }
  return sum.norm() > 0.5f ? sum.normalized() : Eigen::Vector2f::Zero();
}

// The gradient across the outline, `along` full pixels outward of `at`.
float gradient_across(const Image<Eigen::Vector2f>& gradients, const Eigen::Vector2f& at,
                      const Eigen::Vector2f& out, float along) {
  const int u = static_cast<int>(std::lround(at.x() + along * out.x()));
  const int v = static_cast<int>(std::lround(at.y() + along * out.y()));
  return gradients.contains(u, v) ? std::abs(gradients.at(u, v).dot(out)) : 0;
}

}  // namespace

SilhouetteAgreement compare_silhouette(const CheckImage& image,
                                       const Image<Eigen::Vector2f>& gradients,
                                       const PredictedSurface& predicted) {
  if (gradients.empty()) return {};
  const float scale = static_cast<float>(gradients.width / image.width);
  const auto hidden = [&](int u, int v, float z) {
    if (u < 0 || v < 0 || u >= image.width || v >= image.height) return true;
    return hides(image.depth_at(u, v), z);
  };
  double on = 0, beside = 0;
  int count = 0;
  predicted.for_each([&](int u, int v, float z, std::uint32_t) {
    const Eigen::Vector2f out = outward(predicted, u, v, z);
    if (out.isZero(0)) return;
    const int x = u + static_cast<int>(std::lround(2 * out.x()));
    const int y = v + static_cast<int>(std::lround(2 * out.y()));
    if (hidden(u, v, z) || hidden(x, y, z)) return;
    const Eigen::Vector2f pixel(static_cast<float>(u), static_cast<float>(v));
    const Eigen::Vector2f at = scale * (pixel + 0.5f * out + Eigen::Vector2f::Constant(0.5f)) -
                               Eigen::Vector2f::Constant(0.5f);
    float best = 0;
    for (float k = -kOutlineReach * scale; k <= kOutlineReach * scale; ++k) {
      best = std::max(best, gradient_across(gradients, at, out, k));
    }
    float around = 0, steps = 0;
    for (float k = kBesideFrom * scale; k <= kBesideTo * scale; ++k, steps += 2) {
      around += gradient_across(gradients, at, out, k) + gradient_across(gradients, at, out, -k);
    }
    on += double{best};
    beside += double{around / steps};
    ++count;
  });
  if (count < kFewestOutline) return {};
  return {on / count, (on - beside) / count};
}

}  // namespace bpa
