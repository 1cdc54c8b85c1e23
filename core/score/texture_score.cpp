// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/texture_score.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/solve_symmetric.hpp"
#include "core/model/model_index.hpp"
#include "core/score/likelihood.hpp"

namespace bpa {
namespace {

constexpr int kStep = 2;            // pixels; colours are blurred by 1.5
constexpr int kMixed = 2;           // pixels beside the outline whose blurred colours are mixed
constexpr int kShift = 2;           // pixels between colour and depth that are looked for
constexpr int kFewestPixels = 30;   // looked at; fewer cannot tell a pattern from shading
constexpr double kPixelsApart = 7;  // looked-at pixels per independent one: 4 pi (1.5 / kStep)^2
// Of one looked-at pixel: logarithms of the root of light, and of its ratios red and blue to green.
// At medium grey they are 7, 9 and 7 units of CIELAB: what noise, gloss and inexact models leave.
constexpr double kSigma[3] = {0.10, 0.03, 0.06};
constexpr double kLeastSlope = 0.4, kLargestSlope = 1.5;  // contrast, frame to model
constexpr double kRidge = 1e-3;  // of the normals' scatter: a flat face says nothing of the light

using Row = Eigen::Matrix<double, 6, 1>;  // 1, normal, predicted, observed

// Squares of what constants and, for the lightness, normals do not explain.
struct Scatter {
  double predicted, both, observed;
};

Scatter remove_light(const Eigen::Matrix<double, 6, 6>& products) {
  Eigen::Matrix4d known = products.topLeftCorner<4, 4>();
  known.diagonal().tail<3>().array() += kRidge * known(0, 0);
  const Eigen::Vector4d predicted = products.block<4, 1>(0, 4),
                        observed = products.block<4, 1>(0, 5);
  const Eigen::Vector4d p = solve_symmetric(known, predicted), o = solve_symmetric(known, observed);
  return {products(4, 4) - predicted.dot(p), products(4, 5) - predicted.dot(o),
          products(5, 5) - observed.dot(o)};
}

struct Sums {
  Eigen::Matrix<double, 6, 6> lightness = Eigen::Matrix<double, 6, 6>::Zero();
  double chroma[2][5] = {};  // predicted, observed, and the products
  double count = 0;

  void add(const Eigen::Vector3f& normal, const Eigen::Vector3f& predicted,
           const Eigen::Vector3f& observed) {
    Row row;
    row << 1, normal.cast<double>(), double{predicted[0]}, double{observed[0]};
    lightness += row * row.transpose();
    for (int c = 0; c < 2; ++c) {
      const double p = double{predicted[c + 1]}, o = double{observed[c + 1]};
      chroma[c][0] += p, chroma[c][1] += o;
      chroma[c][2] += p * p, chroma[c][3] += p * o, chroma[c][4] += o * o;
    }
    ++count;
  }

  Scatter scatter(int channel) const {
    if (channel == 0) return remove_light(lightness);
    const double* s = chroma[channel - 1];
    return {s[2] - s[0] * s[0] / count, s[3] - s[0] * s[1] / count, s[4] - s[1] * s[1] / count};
  }

  double log_ratio() const {
    double sum = 0;
    for (int channel = 0; channel < 3; ++channel) {
      const auto [pp, po, oo] = scatter(channel);
      const double slope = pp > 0 ? std::clamp(po / pp, kLeastSlope, kLargestSlope) : 1;
      const double left = std::max(0.0, oo - 2 * slope * po + slope * slope * pp);
      const double noise = count * kSigma[channel] * kSigma[channel];
      sum += 0.5 * std::log((noise + std::max(0.0, oo)) / (noise + left));
    }
    return sum;
  }
};

// Whether the blur of colours mixes the pixel with none beside the outline.
bool inside(const PredictedSurface& predicted, int u, int v) {
  return predicted.depth_at(u - kMixed, v) > 0 && predicted.depth_at(u + kMixed, v) > 0 &&
         predicted.depth_at(u, v - kMixed) > 0 && predicted.depth_at(u, v + kMixed) > 0;
}

// Calls visit(u, v, point) for every step-th pixel that may show the surface's colours.
void for_each_shown(const CheckImage& image, const PredictedSurface& predicted, int step,
                    const auto& visit) {
  predicted.for_each([&](int u, int v, float z, std::uint32_t point) {
    if (u % step != 0 || v % step != 0) return;
    if (may_show(image, u, v, z)) visit(u, v, point);
  });
}

}  // namespace

TextureAgreement compare_texture(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                                 const ObjectModel& model, const PredictedSurface& predicted) {
  const std::vector<Eigen::Vector3f>& colors = model.index->log_light;
  if (observed.empty() || colors.empty()) return {};
  Sums sums[3][3];
  for_each_shown(image, predicted, kStep, [&](int u, int v, std::uint32_t point) {
    if (!inside(predicted, u, v)) return;
    if (!observed.contains(u - kShift, v - kShift) || !observed.contains(u + kShift, v + kShift)) {
      return;
    }
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < 3; ++x) {
        sums[y][x].add(model.surface.normals[point], colors[point],
                       observed.at(u + kShift * (x - 1), v + kShift * (y - 1)));
      }
    }
  });
  if (sums[0][0].count < kFewestPixels) return {0, 0};
  TextureAgreement best{-INFINITY, 0};
  for (const auto& row : sums) {
    for (const Sums& shifted : row) best.log_ratio = std::max(best.log_ratio, shifted.log_ratio());
  }
  best.total = best.log_ratio * sums[0][0].count / kPixelsApart;
  return best;
}

Pose turn_to_pattern(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                     const ObjectModel& model, const Pose& camera_from_object) {
  constexpr int kTurnStep = 4;             // pixels: there are many turns to try
  constexpr int kTurns = 64;               // 3 mm apart at the rim of a can of 6 cm
  constexpr double kClearlyBetter = 0.05;  // log-likelihood ratio of a pixel
  const std::vector<Eigen::Vector3f>& colors = model.index->log_light;
  if (observed.empty() || colors.empty() || model.symmetry.trivial()) return camera_from_object;
  struct Pixel {
    int u, v;
    std::uint32_t point;
  };
  std::vector<Pixel> shown;
  for_each_shown(image, predict_surface(image, model, camera_from_object), kTurnStep,
                 [&](int u, int v, std::uint32_t point) {
                   shown.push_back({u, v, point});
                 });
  Pose best = camera_from_object;
  double best_ratio = -INFINITY;
  for (const Pose& element : sampled_elements(model.symmetry, kTurns)) {
    const FastPose turned_from_object = to_fast(element.inverse());
    Sums sums;
    for (const auto& [u, v, point] : shown) {
      const int there =
          model.index->distances.nearest_to(turned_from_object * model.surface.points[point]);
      if (there < 0) continue;
      sums.add(model.surface.normals[point], colors[static_cast<std::size_t>(there)],
               observed.at(u, v));
    }
    if (sums.count < kFewestPixels) continue;
    const double ratio = sums.log_ratio();
    if (ratio <= best_ratio) continue;
    best_ratio =
        ratio + (best_ratio == -INFINITY ? kClearlyBetter : 0);  // the pose itself is first
    best = camera_from_object * element;
  }
  return best;
}

}  // namespace bpa
