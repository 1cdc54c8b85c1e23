// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/sim/private/shapes.hpp"

namespace bpa::sim {
namespace {

using std::numbers::pi;

double polyline_distance(const Eigen::Vector2d& p, const Profile& corners) {
  double squared = 1e9;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Eigen::Vector2d edge = corners[i + 1] - corners[i];
    const double t = std::clamp((p - corners[i]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    squared = std::min(squared, (p - corners[i] - t * edge).squaredNorm());
  }
  return std::sqrt(squared);
}

Eigen::Vector2d radius_and_height(const Eigen::Vector3d& p) { return {p.head<2>().norm(), p.z()}; }

double angle_of(const Eigen::Vector3d& p) { return std::atan2(p.y(), p.x()); }

// A wall of even thickness, turned about z.
DistanceField shell(Profile middle, double thickness) {
  return [middle = std::move(middle), thickness](const Eigen::Vector3d& p) {
    return polyline_distance(radius_and_height(p), middle) - thickness / 2;
  };
}

// A solid turned about z; its outline starts and ends on the axis.
DistanceField solid(const Profile& outline, double rounding) {
  return [polygon = mirrored(outline), rounding](const Eigen::Vector3d& p) {
    return polygon_distance(radius_and_height(p), polygon) - rounding;
  };
}

Bounds round_box(double radius, double low, double high) {
  return {{-radius, -radius, low}, {radius, radius, high}};
}

Shape mug() {
  const Profile middle{{0, 0.003}, {0.0375, 0.003}, {0.0395, 0.005}, {0.0395, 0.0925}};
  const Eigen::Vector3d handle(0.043, 0, 0.05);
  const DistanceField wall = shell(middle, 0.0045);
  Shape s{"mug", {{-0.04175, -0.04175, 0.00075}, {0.043 + 0.0315, 0.04175, 0.09475}}, {0.6, 0.35}};
  s.field = [wall, handle](const Eigen::Vector3d& p) {
    const double ring = std::max(torus_xz_distance(p, handle, 0.026, 0.0055),
                                 0.0385 - p.head<2>().norm());  // not inside the mug
    return smooth_union(wall(p), ring, 0.004);
  };
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    const bool stripe = std::abs(p.z() - 0.075) < 0.005 || std::abs(p.z() - 0.02) < 0.004;
    const double radius = p.head<2>().norm();
    const bool outside = radius > 0.0395 && radius < 0.0425;
    return stripe && outside ? Color(0.95, 0.9, 0.8) : Color(0.72, 0.09, 0.08);
  };
  s.telltale = [](const Eigen::Vector3d& p) { return p.head<2>().norm() > 0.0425; };
  add_shell_parts({{0, 0.003}, {0.0395, 0.003}, {0.0395, 0.0925}}, 0.0045, s.parts);
  for (int i = -2; i < 2; ++i) {
    const auto at = [&handle](int step) {
      const double a = 0.62 * step;
      return Eigen::Vector3d(handle + 0.026 * Eigen::Vector3d(std::cos(a), 0, std::sin(a)));
    };
    s.parts.push_back(capsule_part(at(i), at(i + 1), 0.0055, 0.0055));
  }
  return s;
}

Profile bowl_profile(int steps) {
  Profile middle{{0, 0.00225}, {0.025, 0.00225}};
  for (int i = 1; i <= steps; ++i) {
    const double a = pi / 2 * i / steps;
    middle.push_back({0.025 + 0.05 * std::sin(a), 0.00225 + 0.0555 * (1 - std::cos(a))});
  }
  return middle;
}

Shape bowl() {
  Shape s{"bowl", round_box(0.07725, 0, 0.06), {0.7, 0.3}, turning_z()};
  s.field = shell(bowl_profile(12), 0.0045);
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    const bool inside = n.head<2>().dot(p.head<2>()) < 0;
    if (inside) return Color(0.9, 0.88, 0.8);
    const double wave = 0.004 * std::sin(8 * angle_of(p));
    return p.z() + wave > 0.04 ? Color(0.15, 0.35, 0.65) : Color(0.85, 0.83, 0.76);
  };
  add_shell_parts(bowl_profile(3), 0.0045, s.parts);
  return s;
}

Shape bottle() {
  const Profile outline{{0, 0.001},      {0.031, 0.001},  {0.033, 0.004}, {0.033, 0.115},
                        {0.0295, 0.14},  {0.0145, 0.168}, {0.012, 0.195}, {0.012, 0.201},
                        {0.0145, 0.203}, {0.0145, 0.217}, {0, 0.217}};
  Shape s{"bottle", round_box(0.034, 0, 0.218), {0.17, 0.6}, turning_z()};
  s.field = solid(outline, 0.001);
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    if (p.z() > 0.202) return Color(0.75, 0.6, 0.15);
    if (p.z() < 0.03 || p.z() > 0.105) return Color(0.1, 0.2, 0.08);
    const double ink = print_pattern(0.034 * angle_of(p), p.z(), 0.012);
    return mix(Color(0.9, 0.87, 0.7), Color(0.55, 0.1, 0.1), ink);
  };
  add_solid_parts({{0.033, 0}, {0.034, 0.115}, {0.0305, 0.14}, {0.0155, 0.168}, {0.0145, 0.218}},
                  s.parts);
  return s;
}

Shape can() {
  const Profile outline{{0, 0.0035},     {0.028, 0.0035}, {0.03, 0.001},   {0.0325, 0.001},
                        {0.033, 0.004},  {0.033, 0.106},  {0.0325, 0.109}, {0.03, 0.109},
                        {0.028, 0.1065}, {0, 0.1065}};
  Shape s{"can", round_box(0.034, 0, 0.11), {0.5, 0.65}, turning_z_and_flip()};
  s.field = solid(outline, 0.001);
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    if (std::abs(n.z()) > 0.7 || p.z() < 0.006 || p.z() > 0.104) return Color(0.72, 0.73, 0.75);
    const double u = 0.034 * angle_of(p);
    if (std::abs(std::remainder(u, 0.107)) < 0.024 && std::abs(p.z() - 0.06) < 0.022) {
      return mix(Color(0.95, 0.93, 0.85), Color(0.1, 0.1, 0.1), print_pattern(u, p.z(), 0.01));
    }
    return p.z() < 0.03 ? Color(0.9, 0.9, 0.85) : Color(0.75, 0.12, 0.1);
  };
  add_solid_parts({{0.034, 0}, {0.034, 0.11}}, s.parts);
  return s;
}

Shape cup() {
  Shape s{"cup", round_box(0.0428, 0, 0.107), {0.8, 0.05}, turning_z(), 0.0019};
  s.field = [wall = shell({{0, 0.006}, {0.0265, 0.006}, {0.0385, 0.104}}, 0.0038)](
                const Eigen::Vector3d& p) {
    const double rim = (radius_and_height(p) - Eigen::Vector2d(0.0398, 0.104)).norm() - 0.003;
    const double foot =
        polyline_distance(radius_and_height(p), {{0.0261, 0.0019}, {0.0265, 0.006}}) - 0.0019;
    return std::min({wall(p), rim, foot});
  };
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    const bool inside = n.head<2>().dot(p.head<2>()) < 0;
    if (inside || p.z() > 0.1) return Color(0.93, 0.93, 0.9);
    const double a = 6 * angle_of(p) / pi + p.z() / 0.03;
    return std::abs(a - std::round(a)) < 0.22 ? Color(0.1, 0.5, 0.35) : Color(0.92, 0.9, 0.85);
  };
  add_shell_parts({{0, 0.006}, {0.0265, 0.006}, {0.0385, 0.105}}, 0.0038, s.parts);
  ConvexPart foot = s.parts.front();
  for (Eigen::Vector3f& point : foot) point.z() *= 0.5f;
  s.parts.push_back(foot);
  return s;
}

Shape tube() {
  Shape s{"tube", round_box(0.0227, 0, 0.17), {0.6, 0.0}, turning_z_and_flip()};
  s.field = shell({{0.0205, 0.0022}, {0.0205, 0.1678}}, 0.0044);
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    const double spiral = angle_of(p) / (2 * pi) + p.z() / 0.06;
    return mix(Color(0.62, 0.48, 0.32), Color(0.5, 0.37, 0.24),
               spiral - std::floor(spiral) < 0.08 ? 1 : smooth_noise(p, 0.012));
  };
  add_shell_parts({{0.0205, 0}, {0.0205, 0.17}}, 0.0044, s.parts);
  return s;
}

Shape funnel() {
  Shape s{"funnel", round_box(0.0579, 0, 0.115), {0.45, 0.25}, turning_z(), 0.0019};
  s.field = shell({{0.0085, 0.0019}, {0.0105, 0.048}, {0.056, 0.104}, {0.056, 0.1131}}, 0.0038);
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    const Color blue(0.1, 0.3, 0.7);
    return p.z() > 0.103 ? mix(blue, Color(1, 1, 1), 0.3) : blue;
  };
  add_shell_parts({{0.0085, 0}, {0.0105, 0.048}, {0.056, 0.104}, {0.056, 0.115}}, 0.0038, s.parts);
  return s;
}

Shape plate() {
  const Profile middle{
      {0, 0.0023}, {0.058, 0.0023}, {0.068, 0.0045}, {0.078, 0.0095}, {0.1027, 0.0157}};
  Shape s{"plate", round_box(0.105, 0, 0.018), {0.75, 0.4}, turning_z(), 0.0026};
  s.field = shell(middle, 0.0046);
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    const double r = p.head<2>().norm();
    if (n.z() > 0 && (std::abs(r - 0.097) < 0.003 || std::abs(r - 0.08) < 0.0015)) {
      return Color(0.2, 0.3, 0.55);
    }
    return Color(0.9, 0.89, 0.86);
  };
  add_shell_parts({{0, 0.0023}, {0.06, 0.0023}, {0.078, 0.0095}, {0.1027, 0.0157}}, 0.0046,
                  s.parts);
  return s;
}

}  // namespace

std::vector<Shape> vessel_shapes() {
  return {mug(), bowl(), bottle(), can(), cup(), tube(), funnel(), plate()};
}

}  // namespace bpa::sim
