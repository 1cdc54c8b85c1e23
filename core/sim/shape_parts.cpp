// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/sim/private/shapes.hpp"

namespace bpa::sim {
namespace {

constexpr int kSides = 24;    // of a round part
constexpr int kSectors = 12;  // of a round wall
constexpr double kTurn = 2 * std::numbers::pi;

Pose turn(const Eigen::Vector3d& axis, double angle) {
  return {rotation_from_vector(angle * axis), Eigen::Vector3d::Zero()};
}

void add_arc(double radius, double height, double first, double last, int count, ConvexPart& part) {
  for (int i = 0; i < count; ++i) {
    const double angle = first + (last - first) * i / std::max(count - 1, 1);
    part.push_back(
        Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), height).cast<float>());
  }
}

void add_circle(double radius, double height, ConvexPart& part) {
  add_arc(radius, height, 0, kTurn * (kSides - 1) / kSides, kSides, part);
}

}  // namespace

SymmetryGroup turning_z() { return {{}, {ContinuousSymmetry{}}}; }

SymmetryGroup turning_z_and_flip() {
  return {{turn(Eigen::Vector3d::UnitX(), kTurn / 2)}, {ContinuousSymmetry{}}};
}

SymmetryGroup cyclic_z(int order) {
  SymmetryGroup group;
  for (int i = 1; i < order; ++i) {
    group.discrete.push_back(turn(Eigen::Vector3d::UnitZ(), kTurn * i / order));
  }
  return group;
}

SymmetryGroup dihedral_z(int order) {
  SymmetryGroup group = cyclic_z(order);
  for (int i = 0; i < order; ++i) {
    const double angle = kTurn / 2 * i / order;
    group.discrete.push_back(turn(Eigen::Vector3d(std::cos(angle), std::sin(angle), 0), kTurn / 2));
  }
  return group;
}

SymmetryGroup octahedral() {
  // All signed permutation matrices of determinant 1.
  SymmetryGroup group;
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 3; ++y) {
      for (int signs = 0; signs < 4 && x != y; ++signs) {
        Eigen::Matrix3d matrix;
        matrix.col(0) = (signs & 1 ? -1 : 1) * Eigen::Vector3d::Unit(x);
        matrix.col(1) = (signs & 2 ? -1 : 1) * Eigen::Vector3d::Unit(y);
        matrix.col(2) = matrix.col(0).cross(matrix.col(1));
        if (!matrix.isIdentity()) {
          group.discrete.push_back(Pose::from_matrix(matrix, Eigen::Vector3d::Zero()));
        }
      }
    }
  }
  return group;
}

ConvexPart box_part(const Eigen::Vector3d& center, const Eigen::Vector3d& half_size) {
  ConvexPart part;
  for (int c = 0; c < 8; ++c) {
    const Eigen::Vector3d sign(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1);
    part.push_back((center + half_size.cwiseProduct(sign)).cast<float>());
  }
  return part;
}

ConvexPart capsule_part(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius_a,
                        double radius_b) {
  ConvexPart part;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        const Eigen::Vector3d direction = Eigen::Vector3d(x, y, z).normalized();
        part.push_back((a + radius_a * direction).cast<float>());
        part.push_back((b + radius_b * direction).cast<float>());
      }
    }
  }
  return part;
}

ConvexPart prism_y_part(const Profile& polygon, double half_depth) {
  ConvexPart part;
  for (const Eigen::Vector2d& corner : polygon) {
    part.push_back(Eigen::Vector3d(corner.x(), -half_depth, corner.y()).cast<float>());
    part.push_back(Eigen::Vector3d(corner.x(), half_depth, corner.y()).cast<float>());
  }
  return part;
}

void add_solid_parts(const Profile& outline, std::vector<ConvexPart>& parts) {
  for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
    if (outline[i + 1].y() - outline[i].y() < 1e-6) continue;
    ConvexPart part;
    add_circle(outline[i].x(), outline[i].y(), part);
    add_circle(outline[i + 1].x(), outline[i + 1].y(), part);
    parts.push_back(std::move(part));
  }
}

void add_shell_parts(const Profile& middle, double thickness, std::vector<ConvexPart>& parts) {
  for (std::size_t i = 0; i + 1 < middle.size(); ++i) {
    const Eigen::Vector2d a = middle[i], b = middle[i + 1];
    if (a.x() < 1e-6) {  // the flat bottom
      ConvexPart disc;
      add_circle(b.x(), b.y() - thickness / 2, disc);
      add_circle(b.x(), b.y() + thickness / 2, disc);
      parts.push_back(std::move(disc));
      continue;
    }
    const Eigen::Vector2d along = (b - a).normalized();
    const Eigen::Vector2d offset = thickness / 2 * Eigen::Vector2d(along.y(), -along.x());
    for (int s = 0; s < kSectors; ++s) {
      const double first = kTurn * s / kSectors, last = kTurn * (s + 1) / kSectors;
      ConvexPart part;
      for (const Eigen::Vector2d& end : {a, b}) {
        add_arc(end.x() + offset.x(), end.y() + offset.y(), first, last, 3, part);
        add_arc(end.x() - offset.x(), end.y() - offset.y(), first, last, 2, part);
      }
      parts.push_back(std::move(part));
    }
  }
}

double lattice_noise(int x, int y, int z) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343u ^
                    static_cast<std::uint32_t>(y) * 0xd8163841u ^
                    static_cast<std::uint32_t>(z) * 0xcb1ab31fu;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return ((h ^ (h >> 15)) >> 8) * 0x1.0p-24;
}

double smooth_noise(const Eigen::Vector3d& p, double scale) {
  const Eigen::Vector3d q = p / scale;
  const Eigen::Vector3d base = q.array().floor();
  const Eigen::Vector3d f = q - base;
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    double weight = 1;
    Eigen::Vector3i corner;
    for (int a = 0; a < 3; ++a) {
      const double s = f[a] * f[a] * (3 - 2 * f[a]);
      const bool up = (c >> a) & 1;
      weight *= up ? s : 1 - s;
      corner[a] = static_cast<int>(base[a]) + up;
    }
    sum += weight * lattice_noise(corner.x(), corner.y(), corner.z());
  }
  return sum;
}

double print_pattern(double u, double v, double size) {
  const double line = v / (1.6 * size);
  const int row = static_cast<int>(std::floor(line));
  if (line - row > 0.62) return 0;
  const int column = static_cast<int>(std::floor(u / (0.6 * size)));
  return lattice_noise(column, row, 7) < 0.62 && lattice_noise(column / 6, row, 11) < 0.85 ? 1 : 0;
}

Color mix(const Color& a, const Color& b, double t) {
  return a + std::clamp(t, 0.0, 1.0) * (b - a);
}

}  // namespace bpa::sim
