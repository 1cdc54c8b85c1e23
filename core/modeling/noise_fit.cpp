// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/geometry/solve_symmetric.hpp"
#include "core/modeling/posed_view.hpp"

namespace bpa::modeling {
namespace {

using Parameters = Eigen::Matrix<double, 7, 1>;  // logarithms, so that all stay positive

Parameters to_parameters(const NoiseCurve& c) {
  Parameters p;
  p << c.floor, c.edge_height, c.edge_place, c.edge_width, c.angle_height, c.angle_place,
      c.angle_width;
  return p.cwiseMax(1e-9).array().log();
}

NoiseCurve to_curve(const Parameters& p) {
  const Parameters v = p.array().exp();
  return {v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
}

// How far each parameter may move from where it starts: a factor. Places and widths of a sigmoid
// whose height comes out as nothing are not seen in the data and must stay where they are sensible.
Parameters prior_spread() {
  Parameters spread;
  spread << 2, 2, 0.7, 0.7, 2, 0.25, 0.7;
  return spread;
}

double cost_of(std::span<const NoiseBin> bins, const Parameters& p, const Parameters& prior) {
  const NoiseCurve curve = to_curve(p);
  double cost = (p - prior).cwiseQuotient(prior_spread()).squaredNorm();
  for (const NoiseBin& bin : bins) {
    const double r = std::log(bin.sigma / curve(bin.edge_distance, bin.angle));
    cost += 2 * bin.count * r * r;
  }
  return cost;
}

// Half the gradient of the cost and its Gauss-Newton matrix.
void linearise(std::span<const NoiseBin> bins, const Parameters& p, const Parameters& prior,
               Parameters& gradient, Eigen::Matrix<double, 7, 7>& hessian) {
  constexpr double kStep = 1e-5;
  const NoiseCurve curve = to_curve(p);
  std::array<NoiseCurve, 7> moved;
  for (int k = 0; k < 7; ++k) moved[k] = to_curve(p + kStep * Parameters::Unit(k));
  const Parameters weight = prior_spread().cwiseAbs2().cwiseInverse();
  gradient = weight.cwiseProduct(p - prior);
  hessian = weight.asDiagonal();
  for (const NoiseBin& bin : bins) {
    const double log_sigma = std::log(curve(bin.edge_distance, bin.angle));
    Parameters slope;
    for (int k = 0; k < 7; ++k) {
      slope[k] = (std::log(moved[k](bin.edge_distance, bin.angle)) - log_sigma) / kStep;
    }
    gradient += 2 * bin.count * (log_sigma - std::log(bin.sigma)) * slope;
    hessian += 2 * bin.count * slope * slope.transpose();
  }
}

}  // namespace

NoiseCurve fit_noise_curve(std::span<const NoiseBin> bins, const NoiseCurve& start) {
  constexpr double kMinCount = 30;
  constexpr int kMaxIterations = 100;
  // Neighbouring errors resemble each other, and no bin is a perfect sigmoid: none may dominate.
  constexpr double kMaxCount = 400;
  std::vector<NoiseBin> used;
  for (const NoiseBin& bin : bins) {
    if (!(bin.count >= kMinCount && bin.sigma > 0)) continue;
    used.push_back(bin);
    used.back().count = std::min(bin.count, kMaxCount);
  }
  if (used.size() < 7) return start;
  const Parameters prior = to_parameters(start);
  Parameters best = prior;
  double cost = cost_of(used, best, prior);
  double damping = 1e-3;
  for (int iteration = 0; iteration < kMaxIterations && damping < 1e9; ++iteration) {
    Parameters gradient;
    Eigen::Matrix<double, 7, 7> hessian;
    linearise(used, best, prior, gradient, hessian);
    Eigen::Matrix<double, 7, 7> damped = hessian;
    damped.diagonal() *= 1 + damping;
    const Parameters next = best - solve_symmetric(damped, gradient);
    const double next_cost = cost_of(used, next, prior);
    if (!(next_cost < cost)) {
      damping *= 10;
      continue;
    }
    const bool done = cost - next_cost < 1e-9 * cost;
    best = next;
    cost = next_cost;
    damping = std::max(1e-9, 0.2 * damping);
    if (done) break;
  }
  return to_curve(best);
}

}  // namespace bpa::modeling
