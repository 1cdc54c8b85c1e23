// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/sim/private/shapes.hpp"

namespace bpa::sim {
namespace {

Shape cube() {
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.0285);
  Shape s;
  s.name = "cube";
  s.field = [half](const Eigen::Vector3d& p) { return box_distance(p, half, 0.002); };
  s.low = -half;
  s.high = half;
  s.cell = 0.0019;
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    static constexpr std::array<std::array<double, 3>, 6> kColors{{{0.8, 0.1, 0.1},
                                                                   {0.9, 0.45, 0.05},
                                                                   {0.1, 0.5, 0.15},
                                                                   {0.1, 0.2, 0.65},
                                                                   {0.92, 0.92, 0.92},
                                                                   {0.9, 0.85, 0.1}}};
    int axis = 0;
    n.cwiseAbs().maxCoeff(&axis);
    for (int a = 0; a < 3; ++a) {
      const double cell = (p[a] + 0.0285) / 0.019;
      if (a != axis && std::abs(cell - std::round(cell)) < 0.08) return Color(0.06, 0.06, 0.06);
    }
    // Scrambled stickers: the colour depends on face and field.
    const auto field = [&p](int a) { return static_cast<int>((p[a] + 0.0285) / 0.019); };
    const int index = static_cast<int>(
        6 * lattice_noise(2 * axis + (n[axis] > 0), field((axis + 1) % 3), field((axis + 2) % 3)));
    const auto& c = kColors[index];
    return Color(c[0], c[1], c[2]);
  };
  s.material = {0.5, 0.2};
  s.symmetry = octahedral();
  s.parts = {box_part(Eigen::Vector3d::Zero(), half)};
  return s;
}

Shape l_brick() {
  const Profile outline{{0.0015, 0.0015}, {0.0885, 0.0015}, {0.0885, 0.0285},
                        {0.0285, 0.0285}, {0.0285, 0.0585}, {0.0015, 0.0585}};
  Shape s;
  s.name = "l_brick";
  s.field = [outline](const Eigen::Vector3d& p) {
    return extruded(polygon_distance({p.x(), p.z()}, outline) - 0.0015, p.y(), 0.02, 0.0015);
  };
  s.low = {0, -0.02, 0};
  s.high = {0.09, 0.02, 0.06};
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    return mix(Color(0.8, 0.62, 0.35), Color(0.6, 0.42, 0.22),
               smooth_noise({p.x() * 0.2, p.y(), p.z() * 1.5}, 0.006));
  };
  s.material = {0.65, 0.0};
  s.parts = {box_part({0.045, 0, 0.015}, {0.045, 0.02, 0.015}),
             box_part({0.015, 0, 0.045}, {0.015, 0.02, 0.015})};
  return s;
}

Shape stud_block() {
  Shape s;
  s.name = "stud_block";
  s.field = [](const Eigen::Vector3d& p) {
    const double body = box_distance(p, {0.048, 0.032, 0.015}, 0.0012);
    const double from_stud = std::abs(std::abs(p.x()) - 0.016);
    const Eigen::Vector2d stud(std::min(std::abs(p.x()), std::abs(std::abs(p.x()) - 0.032)),
                               std::abs(p.y()) - 0.016);
    const double studs = extruded(stud.norm() - 0.0095, p.z() - 0.015, 0.007, 0.0012);
    const double holes = Eigen::Vector2d(from_stud, p.z()).norm() - 0.008;  // along y
    return std::max(std::min(body, studs), -holes);
  };
  s.low = {-0.048, -0.032, -0.015};
  s.high = {0.048, 0.032, 0.022};
  s.cell = 0.002;
  s.paint = [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return Color(0.85, 0.7, 0.08); };
  s.material = {0.65, 0.3};
  s.symmetry = cyclic_z(2);
  s.parts = {box_part(Eigen::Vector3d::Zero(), {0.048, 0.032, 0.015})};
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; y += 2) {
      s.parts.push_back(box_part({0.032 * x, 0.016 * y, 0.017}, {0.009, 0.0045, 0.005}));
      s.parts.push_back(box_part({0.032 * x, 0.016 * y, 0.017}, {0.0045, 0.009, 0.005}));
      s.parts.push_back(box_part({0.032 * x, 0.016 * y, 0.017}, {0.0067, 0.0067, 0.005}));
    }
  }
  return s;
}

Shape gear() {
  constexpr double kSixth = std::numbers::pi / 3;
  Shape s;
  s.name = "gear";
  s.field = [](const Eigen::Vector3d& p) {
    const double angle = std::atan2(p.y(), p.x());
    const double turned = angle - kSixth * std::round(angle / kSixth);
    const double r = p.head<2>().norm();
    const Eigen::Vector2d q(r * std::cos(turned) - 0.036, r * std::sin(turned));
    const double tooth = rectangle_distance(q, {0.014, 0.0105}, 0.002);
    const double planar = std::max(smooth_union(r - 0.037, tooth, 0.005), 0.011 - r);
    return extruded(planar, p.z(), 0.012, 0.0012);
  };
  s.low = {-0.05, -0.05, -0.012};
  s.high = {0.05, 0.05, 0.012};
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    return std::abs(p.head<2>().norm() - 0.018) < 0.003 ? Color(0.7, 0.15, 0.5)
                                                        : Color(0.35, 0.12, 0.45);
  };
  s.material = {0.35, 0.2};
  s.symmetry = dihedral_z(6);
  add_solid_parts({{0.0375, -0.012}, {0.0375, 0.012}}, s.parts);
  for (int i = 0; i < 3; ++i) {
    ConvexPart bar = box_part(Eigen::Vector3d::Zero(), {0.05, 0.0105, 0.012});
    const Eigen::Quaternionf turn(
        Eigen::AngleAxisf(static_cast<float>(kSixth * i), Eigen::Vector3f::UnitZ()));
    for (Eigen::Vector3f& point : bar) point = turn * point;
    s.parts.push_back(bar);
  }
  return s;
}

// The spine of the banana, an arc in xz that grows thinner towards one end.
Eigen::Vector3d banana_spine(double t) {
  const double angle = -1.0 + 1.9 * t;
  return {0.1 * std::sin(angle), 0, 0.1 * (1 - std::cos(angle))};
}
double banana_radius(double t) {
  return 0.0055 + 0.0125 *
                      std::sqrt(std::max(0.0, std::sin(std::numbers::pi * (0.06 + 0.88 * t)))) *
                      (1.08 - 0.2 * t);
}

Shape banana() {
  constexpr int kSteps = 24;
  Shape s;
  s.name = "banana";
  s.field = [](const Eigen::Vector3d& p) {
    double d = 1e9;
    for (int i = 0; i < kSteps; ++i) {
      const double a = static_cast<double>(i) / kSteps, b = static_cast<double>(i + 1) / kSteps;
      d = smooth_union(
          d,
          capsule_distance(p, banana_spine(a), banana_spine(b), banana_radius(a), banana_radius(b)),
          0.004);
    }
    const double stem = capsule_distance(p, banana_spine(1), banana_spine(1.16), 0.006, 0.0048);
    return smooth_union(d, stem, 0.004);
  };
  s.low = {-0.0954, -0.0191, -0.0194};
  s.high = {0.0981, 0.0191, 0.0694};
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    if (p.x() > 0.085 || p.x() < -0.091) return Color(0.3, 0.22, 0.1);
    return mix(Color(0.93, 0.8, 0.15), Color(0.5, 0.35, 0.1),
               smooth_noise(p, 0.008) > 0.78 ? 0.7 : 0.2 * smooth_noise(p, 0.03));
  };
  s.material = {0.65, 0.1};
  for (int i = 0; i < kSteps; i += 4) {
    const double a = static_cast<double>(i) / kSteps, b = static_cast<double>(i + 4) / kSteps;
    s.parts.push_back(
        capsule_part(banana_spine(a), banana_spine(b), banana_radius(a), banana_radius(b)));
  }
  s.parts.push_back(capsule_part(banana_spine(1), banana_spine(1.16), 0.006, 0.0048));
  return s;
}

}  // namespace

std::vector<Shape> toy_shapes() { return {cube(), l_brick(), stud_block(), gear(), banana()}; }

}  // namespace bpa::sim
