// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

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

void set_box(Shape& s, const Eigen::Vector3d& half_size, double rounding) {
  s.field = [=](const Eigen::Vector3d& p) { return box_distance(p, half_size, rounding); };
  s.low = -half_size;
  s.high = half_size;
  s.parts = {box_part(Eigen::Vector3d::Zero(), half_size)};
}

Shape cereal_box() {
  Shape s;
  s.name = "cereal_box";
  set_box(s, {0.028, 0.075, 0.1}, 0.0015);
  s.cell = 0.0026;
  s.paint = box_print({0.8, 0.2, 0.1}, {0.95, 0.95, 0.9}, {0.85, 0.8, 0.7}, 0.02);
  s.material = {0.7, 0.15};
  s.symmetry = dihedral_z(2);
  return s;
}

Shape snack_box() {
  Shape s;
  s.name = "snack_box";
  set_box(s, {0.042, 0.042, 0.016}, 0.0015);
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    if (std::abs(n.z()) < 0.7) return Color(0.9, 0.85, 0.7);
    const Color ground = (p - Eigen::Vector3d(0.01, 0.01, 0)).head<2>().norm() < 0.02
                             ? Color(0.55, 0.3, 0.12)
                             : Color(0.15, 0.4, 0.2);
    return mix(ground, Color(1, 1, 0.9), p.y() < -0.015 ? print_pattern(p.x(), p.y(), 0.011) : 0);
  };
  s.material = {0.65, 0.1};
  s.symmetry = dihedral_z(4);
  return s;
}

Shape milk_carton() {
  const Profile outline{{-0.033, 0.002}, {0.033, 0.002},  {0.033, 0.135}, {0.002, 0.17},
                        {0.002, 0.188},  {-0.002, 0.188}, {-0.002, 0.17}, {-0.033, 0.135}};
  Shape s;
  s.name = "milk_carton";
  s.field = [outline](const Eigen::Vector3d& p) {
    const double planar = polygon_distance({p.x(), p.z()}, outline) - 0.002;
    return extruded(planar, p.y(), 0.035, 0.0015);
  };
  s.low = {-0.035, -0.035, 0};
  s.high = {0.035, 0.035, 0.19};
  s.cell = 0.0024;
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    if (p.z() > 0.134) return Color(0.2, 0.35, 0.75);
    const double wave = 0.06 + 0.012 * std::sin(80 * (p.x() + p.y()));
    if (p.z() < wave) return Color(0.25, 0.6, 0.3);
    const double u = std::abs(n.x()) > 0.7 ? p.y() : p.x();
    const bool text = p.z() > 0.085 && p.z() < 0.125;
    return mix(Color(0.93, 0.93, 0.95), Color(0.15, 0.2, 0.6),
               text ? print_pattern(u, p.z(), 0.016) : 0);
  };
  s.material = {0.8, 0.1};
  s.symmetry = cyclic_z(2);
  s.parts = {
      box_part({0, 0, 0.0685}, {0.035, 0.035, 0.0685}),
      prism_y_part({{-0.035, 0.136}, {0.035, 0.136}, {0.004, 0.172}, {-0.004, 0.172}}, 0.035),
      box_part({0, 0, 0.18}, {0.004, 0.035, 0.01})};
  return s;
}

Shape spray_bottle() {
  Shape s;
  s.name = "spray_bottle";
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
  s.low = {-0.042, -0.0288, 0};
  s.high = {0.062, 0.0288, 0.206};
  s.cell = 0.0024;
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    if (p.z() > 0.165) return p.x() > 0.035 ? Color(0.85, 0.2, 0.15) : Color(0.92, 0.92, 0.92);
    const bool label = p.z() > 0.025 && p.z() < 0.105 && std::abs(p.x()) < 0.033;
    if (!label) return Color(0.2, 0.55, 0.8);
    return mix(Color(0.95, 0.95, 0.6), Color(0.1, 0.2, 0.5), print_pattern(p.x(), p.z(), 0.014));
  };
  s.material = {0.6, 0.25};
  s.parts = {box_part({0, 0, 0.065}, {0.034, 0.027, 0.064}),
             box_part({0, 0, 0.065}, {0.042, 0.016, 0.062}),
             capsule_part({0, 0, 0.108}, {0, 0, 0.175}, 0.02, 0.013),
             box_part({0.012, 0, 0.193}, {0.034, 0.013, 0.013}),
             capsule_part({0.04, 0, 0.195}, {0.055, 0, 0.195}, 0.008, 0.007),
             capsule_part({0.036, 0, 0.185}, {0.044, 0, 0.148}, 0.005, 0.0045)};
  return s;
}

Shape jug() {
  Shape s;
  s.name = "jug";
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
  s.low = {-0.05, -0.03, 0};
  s.high = {0.05, 0.03, 0.215};
  s.cell = 0.0026;
  s.paint = [](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    if (p.z() > 0.19 && p.x() < 0.004) return Color(0.85, 0.25, 0.1);
    const bool label = std::abs(n.y()) > 0.8 && p.z() > 0.02 && p.z() < 0.08;
    if (!label) return Color(0.93, 0.93, 0.9);
    const double ring = (Eigen::Vector2d(p.x(), p.z()) - Eigen::Vector2d(-0.01, 0.05)).norm();
    if (ring < 0.018) return ring < 0.012 ? Color(0.95, 0.8, 0.1) : Color(0.8, 0.15, 0.15);
    return mix(Color(0.15, 0.3, 0.7), Color(1, 1, 1), print_pattern(p.x(), p.z(), 0.008));
  };
  s.material = {0.8, 0.2};
  s.parts = {box_part({0, 0, 0.043}, {0.05, 0.025, 0.043}),
             box_part({0, 0, 0.043}, {0.045, 0.03, 0.043}),
             box_part({-0.0205, 0, 0.125}, {0.0285, 0.025, 0.041}),
             box_part({0.041, 0, 0.125}, {0.0075, 0.02, 0.041}),
             box_part({0, 0, 0.176}, {0.039, 0.018, 0.014}),
             box_part({-0.016, 0, 0.2}, {0.0145, 0.0145, 0.015})};
  return s;
}

}  // namespace

std::vector<Shape> package_shapes() {
  return {milk_carton(), cereal_box(), snack_box(), spray_bottle(), jug()};
}

}  // namespace bpa::sim
