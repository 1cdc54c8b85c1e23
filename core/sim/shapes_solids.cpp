// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/sim/private/shapes.hpp"

namespace bpa::sim {
namespace {

// Something like print on the faces of a box: a coloured front, small text on the narrow sides.
Paint box_print(const Color& main, const Color& ink, const Color& side, double letter) {
  return [=](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    if (std::abs(n.z()) > 0.7) return mix(main, side, 0.5);
    const bool front = std::abs(n.x()) > std::abs(n.y());
    const double u = front ? p.y() : p.x();
    if (!front) return mix(side, Color(0.1, 0.1, 0.1), print_pattern(u, p.z(), 0.4 * letter));
    const double blob = smooth_noise(p + (n.x() > 0 ? 1.0 : 2.0) * Eigen::Vector3d::Ones(), 0.05);
    const Color ground = mix(main, mix(main, Color(1, 0.9, 0.4), 0.8), blob > 0.55 ? 1 : 0);
    const bool headline = std::fmod(std::abs(p.z()), 0.09) > 0.045;
    return headline ? mix(ground, ink, print_pattern(u, p.z(), letter)) : ground;
  };
}

Shape box(const char* name, const Eigen::Vector3d& half_size, double rounding,
          const Material& material, const SymmetryGroup& symmetry, double cell) {
  Shape s{name, {-half_size, half_size}, material, symmetry, cell};
  s.field = [=](const Eigen::Vector3d& p) { return box_distance(p, half_size, rounding); };
  s.parts = {box_part(Eigen::Vector3d::Zero(), half_size)};
  return s;
}

Shape cereal_box() {
  Shape s = box("cereal_box", {0.028, 0.075, 0.1}, 0.0015, {0.7, 0.15}, dihedral_z(2), 0.0026);
  s.paint = box_print({0.8, 0.2, 0.1}, {0.95, 0.95, 0.9}, {0.85, 0.8, 0.7}, 0.02);
  return s;
}

Shape snack_box() {
  Shape s = box("snack_box", {0.042, 0.042, 0.016}, 0.0015, {0.65, 0.1}, dihedral_z(4), 0.0022);
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    if (std::abs(n.z()) < 0.7) return Color(0.9, 0.85, 0.7);
    const Color ground = (p - Eigen::Vector3d(0.01, 0.01, 0)).head<2>().norm() < 0.02
                             ? Color(0.55, 0.3, 0.12)
                             : Color(0.15, 0.4, 0.2);
    return mix(ground, Color(1, 1, 0.9), p.y() < -0.015 ? print_pattern(p.x(), p.y(), 0.011) : 0);
  };
  return s;
}

Shape milk_carton() {
  const Profile outline{{-0.033, 0.002}, {0.033, 0.002},  {0.033, 0.135}, {0.002, 0.17},
                        {0.002, 0.188},  {-0.002, 0.188}, {-0.002, 0.17}, {-0.033, 0.135}};
  Shape s{
      "milk_carton", {{-0.035, -0.035, 0}, {0.035, 0.035, 0.19}}, {0.8, 0.1}, cyclic_z(2), 0.0024};
  s.field = [outline](const Eigen::Vector3d& p) {
    const double planar = polygon_distance({p.x(), p.z()}, outline) - 0.002;
    return extruded(planar, p.y(), 0.035, 0.0015);
  };
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    if (p.z() > 0.134) return Color(0.2, 0.35, 0.75);
    const double wave = 0.06 + 0.012 * std::sin(80 * (p.x() + p.y()));
    if (p.z() < wave) return Color(0.25, 0.6, 0.3);
    const double u = std::abs(n.x()) > 0.7 ? p.y() : p.x();
    const bool text = p.z() > 0.085 && p.z() < 0.125;
    return mix(Color(0.93, 0.93, 0.95), Color(0.15, 0.2, 0.6),
               text ? print_pattern(u, p.z(), 0.016) : 0);
  };
  s.parts = {
      box_part({0, 0, 0.0685}, {0.035, 0.035, 0.0685}),
      prism_y_part({{-0.035, 0.136}, {0.035, 0.136}, {0.004, 0.172}, {-0.004, 0.172}}, 0.035),
      box_part({0, 0, 0.18}, {0.004, 0.035, 0.01})};
  return s;
}

Shape spray_bottle() {
  Shape s{"spray_bottle", {{-0.042, -0.0288, 0}, {0.062, 0.0288, 0.206}}, {0.6, 0.25}, {}, 0.0024};
  s.field = [](const Eigen::Vector3d& p) {
    const double side = rectangle_distance(p.head<2>(), {0.042, 0.027}, 0.022);
    const double body = extruded(side, p.z() - 0.065, 0.065, 0.006);
    const double neck = capsule_distance(p, {0, 0, 0.108}, {0, 0, 0.175}, 0.019, 0.013);
    const double head =
        box_distance(p - Eigen::Vector3d(0.012, 0, 0.193), {0.034, 0.013, 0.013}, 0.005);
    const double nozzle = capsule_distance(p, {0.04, 0, 0.195}, {0.055, 0, 0.195}, 0.008, 0.007);
    const double trigger = capsule_distance(p, {0.036, 0, 0.185}, {0.044, 0, 0.148}, 0.005, 0.0045);
    const double bottle = smooth_union(body, neck, 0.02);
    const double top = smooth_union(smooth_union(head, nozzle, 0.004), trigger, 0.004);
    return smooth_union(bottle, top, 0.004);
  };
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    if (p.z() > 0.165) return p.x() > 0.035 ? Color(0.85, 0.2, 0.15) : Color(0.92, 0.92, 0.92);
    const bool label = p.z() > 0.025 && p.z() < 0.105 && std::abs(p.x()) < 0.033;
    if (!label) return Color(0.2, 0.55, 0.8);
    return mix(Color(0.95, 0.95, 0.6), Color(0.1, 0.2, 0.5), print_pattern(p.x(), p.z(), 0.014));
  };
  s.parts = {box_part({0, 0, 0.065}, {0.034, 0.027, 0.064}),
             box_part({0, 0, 0.065}, {0.042, 0.016, 0.062}),
             capsule_part({0, 0, 0.108}, {0, 0, 0.175}, 0.02, 0.013),
             box_part({0.012, 0, 0.193}, {0.034, 0.013, 0.013}),
             capsule_part({0.04, 0, 0.195}, {0.055, 0, 0.195}, 0.008, 0.007),
             capsule_part({0.036, 0, 0.185}, {0.044, 0, 0.148}, 0.005, 0.0045)};
  return s;
}

Shape jug() {
  Shape s{"jug", {{-0.05, -0.03, 0}, {0.05, 0.03, 0.215}}, {0.8, 0.2}, {}, 0.0026};
  s.field = [](const Eigen::Vector3d& p) {
    const double narrowing = std::clamp((p.z() - 0.13) / 0.07, 0.0, 1.0);
    const Eigen::Vector2d half(0.05 - 0.012 * narrowing, 0.03 - 0.01 * narrowing);
    const double side = rectangle_distance(p.head<2>(), half, 0.016);
    const double body = extruded(side, p.z() - 0.095, 0.095, 0.012);
    // The slot behind the grip goes through along y.
    const double slot =
        capsule_distance({p.x(), 0, p.z()}, {0.0215, 0, 0.1}, {0.0185, 0, 0.15}, 0.0125, 0.011);
    const double cap =
        cylinder_distance(p - Eigen::Vector3d(-0.016, 0, 0.197), 0.0165, 0.018, 0.0025);
    return smooth_union(smooth_difference(body, slot, 0.012), cap, 0.004);
  };
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    if (p.z() > 0.19 && p.x() < 0.004) return Color(0.85, 0.25, 0.1);
    const bool label = std::abs(n.y()) > 0.8 && p.z() > 0.02 && p.z() < 0.08;
    if (!label) return Color(0.93, 0.93, 0.9);
    const double ring = (Eigen::Vector2d(p.x(), p.z()) - Eigen::Vector2d(-0.01, 0.05)).norm();
    if (ring < 0.018) return ring < 0.012 ? Color(0.95, 0.8, 0.1) : Color(0.8, 0.15, 0.15);
    return mix(Color(0.15, 0.3, 0.7), Color(1, 1, 1), print_pattern(p.x(), p.z(), 0.008));
  };
  s.parts = {box_part({0, 0, 0.043}, {0.05, 0.025, 0.043}),
             box_part({0, 0, 0.043}, {0.045, 0.03, 0.043}),
             box_part({-0.0205, 0, 0.125}, {0.0285, 0.025, 0.041}),
             box_part({0.041, 0, 0.125}, {0.0075, 0.02, 0.041}),
             box_part({0, 0, 0.176}, {0.039, 0.018, 0.014}),
             box_part({-0.016, 0, 0.2}, {0.0145, 0.0145, 0.015})};
  return s;
}

Shape cube() {
  Shape s = box("cube", {0.0285, 0.0285, 0.0285}, 0.002, {0.5, 0.2}, octahedral(), 0.0019);
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    static const Color kColors[6] = {{0.8, 0.1, 0.1},  {0.9, 0.45, 0.05},  {0.1, 0.5, 0.15},
                                     {0.1, 0.2, 0.65}, {0.92, 0.92, 0.92}, {0.9, 0.85, 0.1}};
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
    return kColors[index];
  };
  return s;
}

Shape l_brick() {
  const Profile outline{{0.0015, 0.0015}, {0.0885, 0.0015}, {0.0885, 0.0285},
                        {0.0285, 0.0285}, {0.0285, 0.0585}, {0.0015, 0.0585}};
  Shape s{"l_brick", {{0, -0.02, 0}, {0.09, 0.02, 0.06}}, {0.65, 0.0}};
  s.field = [outline](const Eigen::Vector3d& p) {
    return extruded(polygon_distance({p.x(), p.z()}, outline) - 0.0015, p.y(), 0.02, 0.0015);
  };
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    return mix(Color(0.8, 0.62, 0.35), Color(0.6, 0.42, 0.22),
               smooth_noise({p.x() * 0.2, p.y(), p.z() * 1.5}, 0.006));
  };
  s.parts = {box_part({0.045, 0, 0.015}, {0.045, 0.02, 0.015}),
             box_part({0.015, 0, 0.045}, {0.015, 0.02, 0.015})};
  return s;
}

Shape stud_block() {
  Shape s{"stud_block",
          {{-0.048, -0.032, -0.015}, {0.048, 0.032, 0.022}},
          {0.65, 0.3},
          cyclic_z(2),
          0.002};
  s.field = [](const Eigen::Vector3d& p) {
    const double body = box_distance(p, {0.048, 0.032, 0.015}, 0.0012);
    const double from_stud = std::abs(std::abs(p.x()) - 0.016);
    const Eigen::Vector2d stud(std::min(std::abs(p.x()), std::abs(std::abs(p.x()) - 0.032)),
                               std::abs(p.y()) - 0.016);
    const double studs = extruded(stud.norm() - 0.0095, p.z() - 0.015, 0.007, 0.0012);
    const double holes = Eigen::Vector2d(from_stud, p.z()).norm() - 0.008;  // along y
    return std::max(std::min(body, studs), -holes);
  };
  s.paint = [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return Color(0.85, 0.7, 0.08); };
  s.parts = {box_part(Eigen::Vector3d::Zero(), {0.048, 0.032, 0.015})};
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; y += 2) {
      const Eigen::Vector3d center(0.032 * x, 0.016 * y, 0.017);
      s.parts.push_back(box_part(center, {0.009, 0.0045, 0.005}));
      s.parts.push_back(box_part(center, {0.0045, 0.009, 0.005}));
      s.parts.push_back(box_part(center, {0.0067, 0.0067, 0.005}));
    }
  }
  return s;
}

Shape gear() {
  constexpr double kSixth = std::numbers::pi / 3;
  Shape s{"gear", {{-0.05, -0.05, -0.012}, {0.05, 0.05, 0.012}}, {0.35, 0.2}, dihedral_z(6)};
  s.field = [](const Eigen::Vector3d& p) {
    const double angle = std::atan2(p.y(), p.x());
    const double turned = angle - kSixth * std::round(angle / kSixth);
    const double r = p.head<2>().norm();
    const Eigen::Vector2d q(r * std::cos(turned) - 0.036, r * std::sin(turned));
    const double tooth = rectangle_distance(q, {0.014, 0.0105}, 0.002);
    const double planar = std::max(smooth_union(r - 0.037, tooth, 0.005), 0.011 - r);
    return extruded(planar, p.z(), 0.012, 0.0012);
  };
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    return std::abs(p.head<2>().norm() - 0.018) < 0.003 ? Color(0.7, 0.15, 0.5)
                                                        : Color(0.35, 0.12, 0.45);
  };
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

// The banana follows an arc in xz and grows thinner towards one end.
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
  constexpr double kSteps = 24;
  Shape s{"banana", {{-0.0954, -0.0191, -0.0194}, {0.0981, 0.0191, 0.0694}}, {0.65, 0.1}};
  s.field = [](const Eigen::Vector3d& p) {
    double d = 1e9;
    for (int i = 0; i < kSteps; ++i) {
      const double a = i / kSteps, b = (i + 1) / kSteps;
      const double piece =
          capsule_distance(p, banana_spine(a), banana_spine(b), banana_radius(a), banana_radius(b));
      d = smooth_union(d, piece, 0.004);
    }
    const double stem = capsule_distance(p, banana_spine(1), banana_spine(1.16), 0.006, 0.0048);
    return smooth_union(d, stem, 0.004);
  };
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    if (p.x() > 0.085 || p.x() < -0.091) return Color(0.3, 0.22, 0.1);
    return mix(Color(0.93, 0.8, 0.15), Color(0.5, 0.35, 0.1),
               smooth_noise(p, 0.008) > 0.78 ? 0.7 : 0.2 * smooth_noise(p, 0.03));
  };
  for (int i = 0; i < kSteps; i += 4) {
    const double a = i / kSteps, b = (i + 4) / kSteps;
    s.parts.push_back(
        capsule_part(banana_spine(a), banana_spine(b), banana_radius(a), banana_radius(b)));
  }
  s.parts.push_back(capsule_part(banana_spine(1), banana_spine(1.16), 0.006, 0.0048));
  return s;
}

}  // namespace

std::vector<Shape> solid_shapes() {
  return {milk_carton(), cereal_box(), snack_box(),  spray_bottle(), jug(),
          cube(),        l_brick(),    stud_block(), gear(),         banana()};
}

}  // namespace bpa::sim
