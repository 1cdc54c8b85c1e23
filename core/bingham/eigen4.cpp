// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/bingham/eigen4.hpp"

#include <Eigen/Eigenvalues>
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

// shift * I - a = L D Lᵀ with ones on the diagonal of L, which is kept below it in `l`.
struct ShiftedFactor {
  Matrix4d l;
  Vector4d diagonal, inverse;  // of D

  /// False if the matrix is not positive.
  bool compute(const Matrix4d& a, double shift) {
    for (int i = 0; i < 4; ++i) {
      diagonal[i] = shift - a(i, i);
      for (int k = 0; k < i; ++k) diagonal[i] -= l(i, k) * l(i, k) * diagonal[k];
      if (!(diagonal[i] > 0)) return false;
      inverse[i] = 1 / diagonal[i];
      for (int j = i + 1; j < 4; ++j) {
        l(j, i) = -a(j, i);
        for (int k = 0; k < i; ++k) l(j, i) -= l(j, k) * l(i, k) * diagonal[k];
        l(j, i) *= inverse[i];
      }
    }
    return true;
  }

  Vector4d solve(const Vector4d& b) const {
    Vector4d x = b;
    for (int i = 1; i < 4; ++i) {
      for (int k = 0; k < i; ++k) x[i] -= l(i, k) * x[k];
    }
    x = x.cwiseProduct(inverse);
    for (int i = 2; i >= 0; --i) {
      for (int k = i + 1; k < 4; ++k) x[i] -= l(k, i) * x[k];
    }
    return x;
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
