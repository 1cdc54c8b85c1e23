// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/bingham/eigen4.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

namespace bpa {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector4d;

// The largest root of x^4 + c2 x^2 + c1 x + c0, all of whose roots are real and at most `bound`,
// from above. Convex there, so Newton's steps never pass it but by rounding.
double largest_root(double c2, double c1, double c0, double bound) {
  double x = bound;
  for (int i = 0; i < 40; ++i) {
    const double value = ((x * x + c2) * x + c1) * x + c0;
    const double slope = (4 * x * x + 2 * c2) * x + c1;
    if (!(slope > 0)) break;
    const double step = value / slope;
    x -= step;
    if (step < 1e-7) break;  // Quadratic: the next step would be of 1e-14.
  }
  return x;
}

// shift * I - a = L D Lᵀ with ones on the diagonal of L. Written out: loops over the elements keep
// them in memory and take a quarter longer.
struct ShiftedFactor {
  double l10, l20, l30, l21, l31, l32;
  std::array<double, 4> inverse;  // of D

  /// False if the matrix is not positive.
  bool compute(const Matrix4d& a, double shift) {
    const double d0 = shift - a(0, 0);
    if (!(d0 > 0)) return false;
    inverse[0] = 1 / d0;
    l10 = -a(1, 0) * inverse[0];
    l20 = -a(2, 0) * inverse[0];
    l30 = -a(3, 0) * inverse[0];
    const double d1 = shift - a(1, 1) - l10 * l10 * d0;
    if (!(d1 > 0)) return false;
    inverse[1] = 1 / d1;
    l21 = (-a(2, 1) - l20 * l10 * d0) * inverse[1];
    l31 = (-a(3, 1) - l30 * l10 * d0) * inverse[1];
    const double d2 = shift - a(2, 2) - l20 * l20 * d0 - l21 * l21 * d1;
    if (!(d2 > 0)) return false;
    inverse[2] = 1 / d2;
    l32 = (-a(3, 2) - l30 * l20 * d0 - l31 * l21 * d1) * inverse[2];
    const double d3 = shift - a(3, 3) - l30 * l30 * d0 - l31 * l31 * d1 - l32 * l32 * d2;
    if (!(d3 > 0)) return false;
    inverse[3] = 1 / d3;
    return true;
  }

  Vector4d solve(const Vector4d& b) const {
    const double y0 = b[0];
    const double y1 = b[1] - l10 * y0;
    const double y2 = b[2] - l20 * y0 - l21 * y1;
    const double y3 = b[3] - l30 * y0 - l31 * y1 - l32 * y2;
    const double x3 = y3 * inverse[3];
    const double x2 = y2 * inverse[2] - l32 * x3;
    const double x1 = y1 * inverse[1] - l21 * x2 - l31 * x3;
    const double x0 = y0 * inverse[0] - l10 * x1 - l20 * x2 - l30 * x3;
    return {x0, x1, x2, x3};
  }
};

// Inverse iteration beside the largest eigenvalue; false when the gap to the next is too small for
// it, or the start happened to be orthogonal to the answer.
bool dominant_by_inverse_iteration(const Matrix4d& matrix, Vector4d& answer) {
  Matrix4d a = matrix;
  a.diagonal().array() -= 0.25 * matrix.trace();
  const double norm = a.norm();
  if (!(norm > 1e-150 && norm < 1e150)) return false;
  a *= 1 / norm;
  const Matrix4d square = a * a;  // Newton's identities with trace(a) = 0, trace(a^2) = 1.
  const double c1 = -a.cwiseProduct(square).sum() / 3;
  const double c0 = 0.125 - 0.25 * square.squaredNorm();
  const double shift = largest_root(-0.5, c1, c0, std::sqrt(0.75) + 1e-12) + 1e-9;
  ShiftedFactor factor;
  if (!factor.compute(a, shift)) return false;
  Vector4d v = factor.solve({0.5377, 0.2833, -0.2588, 0.7512}).normalized();
  v = factor.solve(v).normalized();
  const Vector4d last = factor.solve(v);
  const double size = last.norm();
  answer = last / size;
  // size = 1 / (shift - eigenvalue) up to second order; a small one means another eigenvector.
  return size > 1e6 && (answer - v).squaredNorm() < 1e-16;
}

}  // namespace

SymmetricEigen4 symmetric_eigen(const Matrix4d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix4d> solver(0.5 * (matrix + matrix.transpose()));
  return {solver.eigenvalues().reverse(), solver.eigenvectors().rowwise().reverse()};
}

Vector4d dominant_eigenvector(const Matrix4d& matrix) {
  Vector4d answer;
  if (dominant_by_inverse_iteration(matrix, answer)) return answer;
  return symmetric_eigen(matrix).vectors.col(0);
}

}  // namespace bpa
