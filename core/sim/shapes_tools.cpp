// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/sim/private/shapes.hpp"

// Things of a workshop and a desk: thin, flat, long or small, as few household objects are.

namespace bpa::sim {
namespace {

using Vector = Eigen::Vector3d;

// Two colours, divided at a coordinate.
Paint two_colors(int axis, double at, const Color& below, const Color& above) {
  return [=](const Vector& p, const Vector&) { return p[axis] < at ? below : above; };
}

// What is flat and has two equal halves looks the same from behind.
SymmetryGroup half_turn_x() { return dihedral_z(1); }

// A flat box lying on its largest face, with print on top.
Shape flat_box(const char* name, const Vector& half_size, double rounding, const Color& side,
               const Color& top, const Color& ink, double letter) {
  Shape s{name, {-half_size, half_size}, {0.6, 0.2}, dihedral_z(2)};
  s.cell = std::clamp(0.4 * half_size.z(), 0.0016, 0.0024);
  s.field = [=](const Vector& p) { return box_distance(p, half_size, rounding); };
  s.paint = [=](const Vector& p, const Vector& n) -> Color {
    if (n.z() < 0.7) return side;
    return mix(top, ink, p.y() > 0 ? print_pattern(p.x(), p.y(), letter) : 0);
  };
  s.parts = {box_part(Vector::Zero(), half_size)};
  return s;
}

Shape cylinder(const char* name, double radius, double half_height, const Paint& paint) {
  Shape s{name,
          {{-radius, -radius, -half_height}, {radius, radius, half_height}},
          {0.6, 0.3},
          turning_z_and_flip()};
  s.field = [=](const Vector& p) { return cylinder_distance(p, radius, half_height, 0.0015); };
  s.paint = paint;
  add_solid_parts({{radius, -half_height}, {radius, half_height}}, s.parts);
  return s;
}

Shape tin() {
  return cylinder("tin", 0.042, 0.017, [](const Vector& p, const Vector& n) -> Color {
    if (std::abs(n.z()) > 0.7) return {0.75, 0.75, 0.78};
    const double u = 0.042 * std::atan2(p.y(), p.x());
    return mix(Color(0.1, 0.25, 0.55), Color(0.95, 0.9, 0.8), print_pattern(u, p.z(), 0.009));
  });
}

Shape battery() {
  return cylinder("battery", 0.0165, 0.032, two_colors(2, 0.012, {0.1, 0.1, 0.1}, {0.8, 0.5, 0.1}));
}

Shape pen() {
  Shape s{"pen", {{-0.068, -0.0085, -0.0085}, {0.068, 0.0085, 0.0085}}, {0.6, 0.2}};
  s.symmetry = {{}, {ContinuousSymmetry{.axis = Vector::UnitX()}}};
  s.cell = 0.0017;
  s.field = [](const Vector& p) {
    const double body = capsule_distance(p, {-0.06, 0, 0}, {0.03, 0, 0}, 0.0075, 0.0075);
    const double cap = capsule_distance(p, {0.03, 0, 0}, {0.0595, 0, 0}, 0.0085, 0.0085);
    return std::min(body, cap);
  };
  s.paint = two_colors(0, 0.022, {0.9, 0.9, 0.88}, {0.1, 0.1, 0.12});
  s.parts = {capsule_part({-0.06, 0, 0}, {0.03, 0, 0}, 0.0075, 0.0075),
             capsule_part({0.03, 0, 0}, {0.0595, 0, 0}, 0.0085, 0.0085)};
  return s;
}

Shape screwdriver() {
  Shape s{"screwdriver", {{-0.1, -0.015, -0.015}, {0.11, 0.015, 0.015}}, {0.5, 0.3}};
  s.symmetry = {{}, {ContinuousSymmetry{.axis = Vector::UnitX()}}};
  s.cell = 0.0018;
  s.field = [](const Vector& p) {
    const double handle = capsule_distance(p, {-0.086, 0, 0}, {-0.01, 0, 0}, 0.014, 0.015);
    const double shaft = capsule_distance(p, {-0.01, 0, 0}, {0.106, 0, 0}, 0.004, 0.004);
    return smooth_union(handle, shaft, 0.003);
  };
  s.paint = two_colors(0, 0.005, {0.85, 0.15, 0.1}, {0.55, 0.55, 0.58});
  s.parts = {capsule_part({-0.086, 0, 0}, {-0.01, 0, 0}, 0.014, 0.015),
             capsule_part({-0.01, 0, 0}, {0.106, 0, 0}, 0.004, 0.004)};
  return s;
}

// What is flat: a planar distance in xy, drawn along z.
Shape flat(const char* name, const Bounds& bounds, const SymmetryGroup& symmetry,
           std::function<double(const Eigen::Vector2d&)> planar) {
  Shape s{name, bounds, {0.4, 0.3}, symmetry};
  const double half = bounds.high.z();
  s.cell = std::clamp(0.4 * half, 0.0016, 0.0024);
  s.field = [planar = std::move(planar), half](const Vector& p) {
    return extruded(planar(p.head<2>()), p.z(), half, 0.0008);
  };
  return s;
}

Shape wrench() {
  Shape s = flat(
      "wrench", {{-0.09, -0.021, -0.004}, {0.088, 0.021, 0.004}}, half_turn_x(),
      [](const Eigen::Vector2d& p) {
        const Eigen::Vector2d head(0.069, 0), ring(-0.074, 0);
        const double bar = rectangle_distance(p, {0.07, 0.008}, 0.002);
        const double jaw = (p - head).norm() - 0.021;
        const double gap = rectangle_distance(p - Eigen::Vector2d(0.083, 0), {0.014, 0.009}, 0.002);
        const double eye = (p - ring).norm() - 0.016;
        const double hole = 0.0085 - (p - ring).norm();
        const double outer = smooth_union(smooth_union(bar, jaw, 0.006), eye, 0.006);
        return std::max(std::max(outer, -gap), hole);
      });
  s.paint = two_colors(0, 0.0, {0.45, 0.45, 0.47}, {0.5, 0.5, 0.52});
  s.parts = {box_part({0, 0, 0}, {0.07, 0.008, 0.004}),
             box_part({0.062, 0, 0}, {0.008, 0.02, 0.004}),
             box_part({0.076, 0.0145, 0}, {0.012, 0.0055, 0.004}),
             box_part({0.076, -0.0145, 0}, {0.012, 0.0055, 0.004}),
             box_part({-0.074, 0, 0}, {0.016, 0.012, 0.004})};
  return s;
}

Shape scissors() {
  Shape s = flat("scissors", {{-0.0775, -0.038, -0.004}, {0.095, 0.038, 0.004}}, half_turn_x(),
                 [](const Eigen::Vector2d& p) {
                   const auto blade = [&p](double side) {
                     return capsule_distance({p.x(), side * p.y(), 0}, {-0.045, 0.016, 0},
                                             {0.092, -0.004, 0}, 0.006, 0.003);
                   };
                   const auto ring = [&p](double side) {
                     const double r = (p - Eigen::Vector2d(-0.06, side * 0.0205)).norm();
                     return std::abs(r - 0.0132) - 0.0042;
                   };
                   return std::min(std::min(blade(1), blade(-1)), std::min(ring(1), ring(-1)));
                 });
  s.paint = two_colors(0, -0.025, {0.85, 0.35, 0.05}, {0.6, 0.6, 0.62});
  s.parts = {capsule_part({-0.04, 0, 0}, {0.09, 0, 0}, 0.004, 0.003),
             box_part({-0.06, 0.0205, 0}, {0.0174, 0.0174, 0.004}),
             box_part({-0.06, -0.0205, 0}, {0.0174, 0.0174, 0.004}),
             box_part({0.0, 0, 0}, {0.05, 0.008, 0.004}),
             box_part({0.06, 0, 0}, {0.034, 0.004, 0.004})};
  return s;
}

Shape clamp() {
  Shape s = flat("clamp", {{-0.06, -0.05, -0.011}, {0.06, 0.05, 0.011}}, {},
                 [](const Eigen::Vector2d& p) {
                   const double frame = rectangle_distance(p, {0.06, 0.05}, 0.01);
                   const double mouth =
                       rectangle_distance(p - Eigen::Vector2d(0.02, 0.004), {0.055, 0.033}, 0.008);
                   return std::max(frame, -mouth);
                 });
  s.paint = two_colors(1, -0.02, {0.1, 0.2, 0.6}, {0.12, 0.12, 0.14});
  s.parts = {box_part({-0.0475, 0, 0}, {0.0125, 0.05, 0.011}),
             box_part({0, 0.0435, 0}, {0.06, 0.0065, 0.011}),
             box_part({0, -0.0395, 0}, {0.06, 0.0105, 0.011})};
  return s;
}

Shape spatula() {
  Shape s = flat("spatula", {{-0.11, -0.035, -0.005}, {0.11, 0.035, 0.005}}, half_turn_x(),
                 [](const Eigen::Vector2d& p) {
                   const double blade =
                       rectangle_distance(p - Eigen::Vector2d(0.065, 0), {0.045, 0.035}, 0.012);
                   const double handle =
                       rectangle_distance(p - Eigen::Vector2d(-0.04, 0), {0.07, 0.009}, 0.006);
                   return smooth_union(blade, handle, 0.01);
                 });
  s.paint = two_colors(0, 0.01, {0.2, 0.2, 0.22}, {0.75, 0.1, 0.15});
  s.parts = {box_part({0.065, 0, 0}, {0.045, 0.035, 0.005}),
             box_part({-0.04, 0, 0}, {0.07, 0.009, 0.005})};
  return s;
}

}  // namespace

std::vector<Shape> tool_shapes() {
  return {pen(),
          screwdriver(),
          wrench(),
          scissors(),
          clamp(),
          spatula(),
          tin(),
          battery(),
          flat_box("phone", {0.073, 0.036, 0.005}, 0.004, {0.15, 0.15, 0.16}, {0.05, 0.05, 0.08},
                   {0.5, 0.6, 0.7}, 0.012),
          flat_box("remote", {0.085, 0.022, 0.011}, 0.005, {0.2, 0.2, 0.22}, {0.25, 0.25, 0.27},
                   {0.9, 0.9, 0.9}, 0.007),
          flat_box("book", {0.1, 0.07, 0.014}, 0.0015, {0.92, 0.9, 0.85}, {0.1, 0.4, 0.35},
                   {0.95, 0.85, 0.3}, 0.014),
          flat_box("soap", {0.045, 0.03, 0.014}, 0.009, {0.9, 0.75, 0.8}, {0.92, 0.8, 0.84},
                   {0.7, 0.4, 0.5}, 0.01),
          flat_box("sponge", {0.052, 0.036, 0.023}, 0.004, {0.75, 0.15, 0.1}, {0.8, 0.2, 0.12},
                   {0.8, 0.2, 0.12}, 0.01),
          flat_box("matchbox", {0.04, 0.025, 0.012}, 0.0012, {0.35, 0.25, 0.2}, {0.85, 0.1, 0.1},
                   {0.95, 0.95, 0.8}, 0.009)};
}

}  // namespace bpa::sim
