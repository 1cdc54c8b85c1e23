// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/silhouette_score.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/tolerance.hpp"

namespace bpa::score {
namespace {

// Chosen by hand on simulated piles, as all constants of this file.
constexpr int kFewestOutline = 12;  // pixels of the reduced image
// In pixels of the reduced image: where the outline is looked for, and where its surroundings are.
constexpr float kOutlineReach = 1.5f, kBesideFrom = 2.5f, kBesideTo = 4;

// Predicted depths with kReach pixels of nothing around, so that neighbours are read without
// tests.
struct PaddedDepth {
  static constexpr int kReach = 2;

  explicit PaddedDepth(const PredictedSurface& predicted)
      : u0(predicted.u0 - kReach),
        v0(predicted.v0 - kReach),
        depth(predicted.depth.width + 2 * kReach, predicted.depth.height + 2 * kReach, 0.0f) {
    for (int y = 0; y < predicted.depth.height; ++y) {
      std::copy_n(&predicted.depth.at(0, y), predicted.depth.width, &depth.at(kReach, y + kReach));
    }
  }

  // The direction out of the object at one of its pixels; zero inside of it.
  Eigen::Vector2f outward(int u, int v, float z) const {
    const float* here = &depth.at(u - u0, v - v0);
    const auto outside = [&](int du, int dv) {
      const float there = here[dv * depth.width + du];
      return (there <= 0) | (there > z + tolerance::kOutlineStep);
    };
    if (!(outside(1, 0) | outside(-1, 0) | outside(0, 1) | outside(0, -1))) {
      return Eigen::Vector2f::Zero();
    }
    int sum_u = 0, sum_v = 0;
    for (int dv = -kReach; dv <= kReach; ++dv) {
      for (int du = -kReach; du <= kReach; ++du) {
        const int is_outside = outside(du, dv);
        sum_u += is_outside * du;
        sum_v += is_outside * dv;
      }
    }
    if (sum_u == 0 && sum_v == 0) return Eigen::Vector2f::Zero();
    return Eigen::Vector2f(static_cast<float>(sum_u), static_cast<float>(sum_v)).normalized();
  }

  int u0, v0;  // image pixel of the first one
  Image<float> depth;
};

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
  const PaddedDepth padded(predicted);
  const float scale = static_cast<float>(gradients.width / image.width);
  const auto hidden = [&](int u, int v, float z) {
    if (u < 0 || v < 0 || u >= image.width || v >= image.height) return true;
    return image.hides(image.depth_at(u, v), z);
  };
  double on = 0, beside = 0;
  int count = 0;
  predicted.for_each([&](int u, int v, float z, std::uint32_t) {
    const Eigen::Vector2f out = padded.outward(u, v, z);
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

}  // namespace bpa::score
