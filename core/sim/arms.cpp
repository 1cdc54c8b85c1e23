// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/arms.hpp"

#include <cmath>
#include <numbers>

#include "core/sim/private/shapes.hpp"

namespace bpa::sim {
namespace {

using Vector = Eigen::Vector3d;

const Color kSkin{0.80, 0.60, 0.48}, kSleeve{0.20, 0.28, 0.42};

// One ring of a surface of revolution: where along the axis, how wide, how its normal leans.
struct Ring {
  double along, radius, lean;  // lean: the normal's share along the axis, in [-1, 1]
};

// A surface of revolution about an axis of unit length.
void add_revolved(const Vector& from, const Vector& axis, const std::vector<Ring>& rings,
                  const Color& color, TriangleMesh& mesh) {
  constexpr int kTurns = 20;
  const Vector u = axis.unitOrthogonal(), v = axis.cross(u);
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Ring& ring : rings) {
    const double upright = std::sqrt(std::max(0.0, 1 - ring.lean * ring.lean));
    for (int i = 0; i < kTurns; ++i) {
      const double angle = 2 * std::numbers::pi * i / kTurns;
      const Vector out = std::cos(angle) * u + std::sin(angle) * v;
      const Vector point = from + ring.along * axis + ring.radius * out;
      const Color c = color * (0.9 + 0.2 * smooth_noise(point, 0.012));
      mesh.vertices.push_back(point.cast<float>());
      mesh.normals.push_back((upright * out + ring.lean * axis).cast<float>());
      std::array<std::uint8_t, 3> rgb{};
      for (int k = 0; k < 3; ++k) {
        rgb[k] = static_cast<std::uint8_t>(255 * std::min(1.0, c[k]));
      }
      mesh.colors.push_back(rgb);
    }
  }
  for (std::uint32_t r = 0; r + 1 < rings.size(); ++r) {
    for (std::uint32_t i = 0; i < kTurns; ++i) {
      const std::uint32_t j = (i + 1) % kTurns, a = base + r * kTurns, b = a + kTurns;
      mesh.triangles.push_back({a + i, a + j, b + j});
      mesh.triangles.push_back({a + i, b + j, b + i});
    }
  }
}

// From a (radius ra) to b (radius rb), round at both ends.
void add_capsule(const Vector& a, const Vector& b, double ra, double rb, const Color& color,
                 TriangleMesh& mesh) {
  constexpr int kCap = 6;  // rings of each end
  const double length = (b - a).norm();
  std::vector<Ring> rings;
  for (int i = 0; i <= kCap; ++i) {
    const double angle = 0.5 * std::numbers::pi * i / kCap;  // from the pole to the equator
    rings.push_back({-ra * std::cos(angle), ra * std::sin(angle), -std::cos(angle)});
  }
  for (int i = kCap; i >= 0; --i) {
    const double angle = 0.5 * std::numbers::pi * i / kCap;
    rings.push_back({length + rb * std::cos(angle), rb * std::sin(angle), std::cos(angle)});
  }
  add_revolved(a, (b - a).normalized(), rings, color, mesh);
}

// About `center`; the half axes are along the mesh's axes.
void add_ellipsoid(const Vector& center, const Vector& half, const Color& color,
                   TriangleMesh& mesh) {
  TriangleMesh ball;
  add_capsule({0, 0, -1e-3}, {0, 0, 1e-3}, 1, 1, color, ball);
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::size_t i = 0; i < ball.vertices.size(); ++i) {
    const Vector point = ball.vertices[i].cast<double>().cwiseProduct(half);
    const Vector normal = ball.normals[i].cast<double>().cwiseQuotient(half);
    mesh.vertices.push_back((center + point).cast<float>());
    mesh.normals.push_back(normal.normalized().cast<float>());
    mesh.colors.push_back(ball.colors[i]);
  }
  for (const auto& t : ball.triangles) {
    mesh.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  }
}

// From the wrist up and back, the way of a person who stands at the table.
void add_forearm(const Vector& wrist, TriangleMesh& mesh) {
  const Vector cuff = wrist + Vector(0, 0.10, -0.10), elbow = wrist + Vector(0, 0.24, -0.22);
  add_capsule(wrist, cuff, 0.028, 0.034, kSkin, mesh);
  add_capsule(cuff, elbow, 0.04, 0.048, kSleeve, mesh);
  add_capsule(elbow, elbow + Vector(0, 0.3, -0.2), 0.05, 0.06, kSleeve, mesh);
}

SimulatedObject arm(std::string name, TriangleMesh mesh) {
  constexpr Material kSkinAndCloth{0.6, 0.03};
  return {std::move(name), std::move(mesh), kSkinAndCloth, {}, {}};
}

SimulatedObject straight_arm() {
  TriangleMesh mesh;
  add_capsule({-0.7, 0, 0}, {-0.1, 0, 0}, 0.055, kForearmRadius + 0.003, kSleeve, mesh);
  add_capsule({-0.12, 0, 0}, {0.12, 0, 0}, kForearmRadius, kForearmRadius, kSkin, mesh);
  add_ellipsoid({0.19, 0, 0}, {0.065, 0.045, 0.03}, kSkin, mesh);
  for (int finger = 0; finger < 4; ++finger) {
    const double y = 0.022 * (finger - 1.5);
    add_capsule({0.22, y, 0}, {0.3, 1.2 * y, 0.01}, 0.011, 0.009, kSkin, mesh);
  }
  add_capsule({0.16, 0.035, 0}, {0.22, 0.075, 0}, 0.013, 0.01, kSkin, mesh);
  return arm("straight_arm", std::move(mesh));
}

SimulatedObject fist() {
  TriangleMesh mesh;
  add_ellipsoid(Vector::Zero(), {kFistRadius, kFistRadius, 0.04}, kSkin, mesh);
  add_forearm({0, 0.02, -0.03}, mesh);
  return arm("fist", std::move(mesh));
}

SimulatedObject grip(double width) {
  constexpr double kFinger = 0.009;  // radius, metres
  TriangleMesh mesh;
  const double palm = -kGripDepth - 0.022;
  const double x = 0.5 * width + kFinger;
  add_ellipsoid({0, 0, palm}, {x + 0.012, 0.043, 0.022}, kSkin, mesh);
  for (int finger = 0; finger < 4; ++finger) {
    const double y = 0.021 * (finger - 1.5);
    add_capsule({x, y, palm}, {x, y, -kFinger}, kFinger + 0.001, kFinger, kSkin, mesh);
  }
  add_capsule({-x - 0.002, 0.01, palm}, {-x - 0.002, 0, -kFinger}, kFinger + 0.002, kFinger + 0.002,
              kSkin, mesh);
  add_forearm({0, 0.02, palm - 0.02}, mesh);
  return arm("grip", std::move(mesh));
}

}  // namespace

std::vector<SimulatedObject> make_arms() {
  std::vector<SimulatedObject> arms = {straight_arm(), fist()};
  for (const double width : kGripWidths) arms.push_back(grip(width));
  return arms;
}

}  // namespace bpa::sim
