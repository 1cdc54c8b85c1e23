// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/bingham/normalizer.hpp"

#include <algorithm>
#include <cmath>

namespace bpa {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr int kNodes = 14;

// The upper half of Talbot's contour with 28 nodes, θ = (2k - 1) π / 28:
//   z(θ) = 28 (0.5017 θ cot(0.6407 θ) - 0.6122 + 0.2645 iθ),   weight = 2 e^z z'(θ) / (28 i).
alignas(32) constexpr double kRe[kNodes] = {
    4.746013491478383786,  4.442827174693561472,   3.831370887728828267,  2.901169020296818167,
    1.635700118325439162,  0.01131537344713388154, -2.004414539759504125, -4.455162785465974411,
    -7.399511882829631286, -10.91647539579782776,  -15.11399674595225241, -20.1424169583222521,
    -26.21661038243321486, -33.65403293584179697};
alignas(32) constexpr double kIm[kNodes] = {
    0.8309512568745003116, 2.492853770623500935, 4.154756284372501558, 5.816658798121502181,
    7.478561311870502804,  9.140463825619503427, 10.80236633936850405, 12.46426885311750467,
    14.1261713668665053,   15.78807388061550592, 17.44997639436450654, 19.11187890811350717,
    20.77378142186250779,  22.43568393561150841};
alignas(32) constexpr double kWeightRe[kNodes] = {
    36.9661517347257588,       -43.2926823676305914,    -3.33687914543415121,
    11.44808976645418646,      -1.193805993987424781,   -0.6773315618769455001,
    0.0799605538826911538,     0.007126725049118424005, -0.000622328494808910356,
    -7.799773983326611795e-6,  4.16994674004197774e-7,  1.004491820857137398e-10,
    -8.974643941089349331e-12, 1.582898342430382604e-15};
alignas(32) constexpr double kWeightIm[kNodes] = {
    48.71450735488795552,       17.33797815841912617,     -26.67581768115386223,
    1.332481711736389875,       3.389151138940636239,     -0.4104103177480733336,
    -0.0882725488705048132,     0.009256477647360750322,  0.000330373275786534125,
    -0.00002286902058722505105, -7.442782879257548819e-8, 3.272359516560236229e-9,
    -9.912038135705461191e-13,  -6.302895369762298268e-15};

constexpr double kLog2PiSquared = 2.9826069522587457;        // log(2 π²)
constexpr double kLog2PiToThreeHalves = 2.4102420093340456;  // log(2 π^(3/2))

// λ relative to its largest entry, and a scale for entries so large that products of them overflow:
// the factor (z - λ) is kept as (z scale - λ scale).
template <int N>
struct Shifted {
  double top = 0;
  double log_scales = 0;  // Sum of log(scale).
  Eigen::Matrix<double, N, 1> scaled, scale;

  explicit Shifted(const Eigen::Matrix<double, N, 1>& lambda) : top(lambda.maxCoeff()) {
    for (int i = 0; i < N; ++i) {
      scaled[i] = lambda[i] - top;
      scale[i] = 1;
      if (scaled[i] < -1e30) {
        scale[i] = -1 / scaled[i];
        scaled[i] = -1;
        log_scales += std::log(scale[i]);
      }
    }
  }
};

// The square root with positive imaginary part.
inline void upper_sqrt(double re, double im, double& root_re, double& root_im) {
  const double modulus = std::sqrt(re * re + im * im);
  const double large = std::sqrt(0.5 * (modulus + std::abs(re)));
  const double small = 0.5 * std::abs(im) / large;
  root_re = std::copysign(re < 0 ? small : large, im);
  root_im = re < 0 ? large : small;
}

// Real and imaginary part of Π (z - λi)^(-1/2) at one node. Both (z - λ0)(z - λ1) and the other
// pair have arguments in (0, 2π), so their continuous square roots are those in the upper half
// plane.
inline void integrand(const Shifted<4>& s, int k, double& re, double& im) {
  double a[4], b[4];
  for (int i = 0; i < 4; ++i) {
    a[i] = kRe[k] * s.scale[i] - s.scaled[i];
    b[i] = kIm[k] * s.scale[i];
  }
  double p, q, u, v;
  upper_sqrt(a[0] * a[1] - b[0] * b[1], a[0] * b[1] + a[1] * b[0], p, q);
  upper_sqrt(a[2] * a[3] - b[2] * b[3], a[2] * b[3] + a[3] * b[2], u, v);
  const double root_re = p * u - q * v;
  const double root_im = p * v + q * u;
  const double inverse = 1 / (root_re * root_re + root_im * root_im);
  re = root_re * inverse;
  im = -root_im * inverse;
}

}  // namespace

double bingham_log_normalizer(const Vector4d& lambda) {
  const Shifted<4> s(lambda);
  double terms[kNodes];
  for (int k = 0; k < kNodes; ++k) {
    double re, im;
    integrand(s, k, re, im);
    terms[k] = kWeightRe[k] * re - kWeightIm[k] * im;
  }
  double sum = 0;
  for (double term : terms) sum += term;
  return kLog2PiSquared + s.top + std::log(sum) + 0.5 * s.log_scales;
}

BinghamNormalizer bingham_normalizer(const Vector4d& lambda) {
  const Shifted<4> s(lambda);
  double f = 0;
  Vector4d first = Vector4d::Zero();
  Matrix4d second = Matrix4d::Zero();
  for (int k = 0; k < kNodes; ++k) {
    double f_re, f_im;
    integrand(s, k, f_re, f_im);
    const double re = kWeightRe[k] * f_re - kWeightIm[k] * f_im;
    const double im = kWeightRe[k] * f_im + kWeightIm[k] * f_re;
    f += re;
    Vector4d c, d;  // ½ scale / (z - λ)
    for (int i = 0; i < 4; ++i) {
      const double a = kRe[k] * s.scale[i] - s.scaled[i];
      const double b = kIm[k] * s.scale[i];
      const double factor = 0.5 * s.scale[i] / (a * a + b * b);
      c[i] = a * factor;
      d[i] = -b * factor;
    }
    const Vector4d g_re = re * c - im * d;
    const Vector4d g_im = re * d + im * c;
    first += g_re;
    second += g_re * c.transpose() - g_im * d.transpose();
  }
  second.diagonal() *= 3;
  BinghamNormalizer result;
  result.log_f = kLog2PiSquared + s.top + std::log(f) + 0.5 * s.log_scales;
  result.gradient = first / f;
  result.fourth = second / f;
  return result;
}

namespace {

// f and its gradient over the 2-sphere, up to the constant factor.
double integral_s2(const Shifted<3>& s, Vector3d* gradient) {
  double f = 0;
  if (gradient != nullptr) gradient->setZero();
  for (int k = 0; k < kNodes; ++k) {
    Vector3d a = kRe[k] * s.scale - s.scaled;
    Vector3d b = kIm[k] * s.scale;
    double p, q, u, v;
    upper_sqrt(a[0] * a[1] - b[0] * b[1], a[0] * b[1] + a[1] * b[0], p, q);
    upper_sqrt(a[2], b[2], u, v);
    const double root_re = p * u - q * v;
    const double root_im = p * v + q * u;
    const double inverse = 1 / (root_re * root_re + root_im * root_im);
    const double re = (kWeightRe[k] * root_re + kWeightIm[k] * root_im) * inverse;
    const double im = (kWeightIm[k] * root_re - kWeightRe[k] * root_im) * inverse;
    f += re;
    if (gradient == nullptr) continue;
    for (int i = 0; i < 3; ++i) {
      (*gradient)[i] += 0.5 * s.scale[i] * (re * a[i] + im * b[i]) / (a[i] * a[i] + b[i] * b[i]);
    }
  }
  return f;
}

}  // namespace

double bingham_log_normalizer_s2(const Vector3d& lambda) {
  const Shifted<3> s(lambda);
  return kLog2PiToThreeHalves + s.top + std::log(integral_s2(s, nullptr)) + 0.5 * s.log_scales;
}

Vector3d bingham_gradient_s2(const Vector3d& lambda) {
  const Shifted<3> s(lambda);
  Vector3d gradient;
  const double f = integral_s2(s, &gradient);
  return gradient / f;
}

}  // namespace bpa
