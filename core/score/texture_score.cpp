// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/texture_score.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/solve_symmetric.hpp"
#include "core/model/model_index.hpp"
#include "core/score/likelihood.hpp"

namespace bpa::score {
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

// Squares of what constants and, for the lightness, normals do not explain.
struct Scatter {
  double predicted, both, observed;
};

// Sums over looked-at pixels of what a placement predicts.
struct PredictedSums {
  Eigen::Matrix4d known = Eigen::Matrix4d::Zero();      // products of 1 and the normal
  Eigen::Vector4d lightness = Eigen::Vector4d::Zero();  // these by the lightness
  double squared_lightness = 0;
  double chroma[2] = {}, squared_chroma[2] = {};

  void add(const Eigen::Vector4d& row, const Eigen::Vector3d& predicted) {
    known += row * row.transpose();
    lightness += row * predicted[0];
    squared_lightness += predicted[0] * predicted[0];
    for (int c = 0; c < 2; ++c) {
      chroma[c] += predicted[c + 1];
      squared_chroma[c] += predicted[c + 1] * predicted[c + 1];
    }
  }
  double count() const { return known(0, 0); }
};

// Sums over the same pixels of what is observed, and its products with what is predicted.
struct ObservedSums {
  Eigen::Vector4d lightness = Eigen::Vector4d::Zero();
  double lightness_both = 0, squared_lightness = 0;
  double chroma[2] = {}, chroma_both[2] = {}, squared_chroma[2] = {};

  void add(const Eigen::Vector4d& row, const Eigen::Vector3d& predicted,
           const Eigen::Vector3d& observed) {
    lightness += row * observed[0];
    lightness_both += predicted[0] * observed[0];
    squared_lightness += observed[0] * observed[0];
    for (int c = 0; c < 2; ++c) {
      chroma[c] += observed[c + 1];
      chroma_both[c] += predicted[c + 1] * observed[c + 1];
      squared_chroma[c] += observed[c + 1] * observed[c + 1];
    }
  }
};

Scatter scatter(const PredictedSums& p, const ObservedSums& o, int channel) {
  if (channel == 0) {
    Eigen::Matrix4d known = p.known;
    known.diagonal().tail<3>().array() += kRidge * known(0, 0);
    const Eigen::Vector4d by_predicted = solve_symmetric(known, p.lightness),
                          by_observed = solve_symmetric(known, o.lightness);
    return {p.squared_lightness - p.lightness.dot(by_predicted),
            o.lightness_both - p.lightness.dot(by_observed),
            o.squared_lightness - o.lightness.dot(by_observed)};
  }
  const int c = channel - 1;
  return {p.squared_chroma[c] - p.chroma[c] * p.chroma[c] / p.count(),
          o.chroma_both[c] - p.chroma[c] * o.chroma[c] / p.count(),
          o.squared_chroma[c] - o.chroma[c] * o.chroma[c] / p.count()};
}

double log_ratio(const PredictedSums& predicted, const ObservedSums& observed) {
  double sum = 0;
  for (int channel = 0; channel < 3; ++channel) {
    const auto [pp, po, oo] = scatter(predicted, observed, channel);
    const double slope = pp > 0 ? std::clamp(po / pp, kLeastSlope, kLargestSlope) : 1;
    const double left = std::max(0.0, oo - 2 * slope * po + slope * slope * pp);
    const double noise = predicted.count() * kSigma[channel] * kSigma[channel];
    sum += 0.5 * std::log((noise + std::max(0.0, oo)) / (noise + left));
  }
  return sum;
}

// 1 and a normal.
Eigen::Vector4d light_row(const Eigen::Vector3f& normal) {
  const Eigen::Vector3d n = normal.cast<double>();
  return {1, n.x(), n.y(), n.z()};
}

// Whether the blur of colours mixes the pixel with none beside the outline.
bool is_inside(const PredictedSurface& predicted, int u, int v) {
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
  PredictedSums sums;
  ObservedSums shifted[3][3];
  for_each_shown(image, predicted, kStep, [&](int u, int v, std::uint32_t point) {
    if (!is_inside(predicted, u, v)) return;
    if (!observed.contains(u - kShift, v - kShift) || !observed.contains(u + kShift, v + kShift)) {
      return;
    }
    const Eigen::Vector4d row = light_row(model.surface.normals[point]);
    const Eigen::Vector3d predicted_color = colors[point].cast<double>();
    sums.add(row, predicted_color);
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < 3; ++x) {
        const Eigen::Vector3f& seen = observed.at(u + kShift * (x - 1), v + kShift * (y - 1));
        shifted[y][x].add(row, predicted_color, seen.cast<double>());
      }
    }
  });
  if (sums.count() < kFewestPixels) return {0, 0};
  TextureAgreement best{-INFINITY, 0};
  for (const auto& row : shifted) {
    for (const ObservedSums& seen : row) {
      best.log_ratio = std::max(best.log_ratio, log_ratio(sums, seen));
    }
  }
  best.total = best.log_ratio * sums.count() / kPixelsApart;
  return best;
}

Pose turn_to_pattern(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                     const ObjectModel& model, const Pose& camera_from_object,
                     const PredictedSurface& predicted) {
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
  for_each_shown(image, predicted, kTurnStep, [&](int u, int v, std::uint32_t point) {
    shown.push_back({u, v, point});
  });
  Pose best = camera_from_object;
  double best_ratio = -INFINITY;
  for (const Pose& element : sampled_elements(model.symmetry, kTurns)) {
    const FastPose turned_from_object = to_fast(element.inverse());
    PredictedSums sums;
    ObservedSums seen;
    for (const auto& [u, v, point] : shown) {
      const int there =
          model.index->distances.nearest_to(turned_from_object * model.surface.points[point]);
      if (there < 0) continue;
      const Eigen::Vector4d row = light_row(model.surface.normals[point]);
      const Eigen::Vector3d color = colors[static_cast<std::size_t>(there)].cast<double>();
      sums.add(row, color);
      seen.add(row, color, observed.at(u, v).cast<double>());
    }
    if (sums.count() < kFewestPixels) continue;
    const double ratio = log_ratio(sums, seen);
    if (ratio <= best_ratio) continue;
    best_ratio =
        ratio + (best_ratio == -INFINITY ? kClearlyBetter : 0);  // the pose itself is first
    best = camera_from_object * element;
  }
  return best;
}

}  // namespace bpa::score
