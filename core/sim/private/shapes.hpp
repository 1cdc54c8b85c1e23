// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/sim/distance_field.hpp"
#include "core/sim/objects.hpp"

// How the household objects are described before they are meshed.

namespace bpa::sim {

using Color = Eigen::Vector3d;  ///< rgb in [0, 1].
using Paint = std::function<Color(const Eigen::Vector3d& point, const Eigen::Vector3d& normal)>;

/// Two corners of an axis-aligned box, metres.
struct Bounds {
  Eigen::Vector3d low, high;
};

/// One object: what it is made of, in a frame of its own (z up).
struct Shape {
  std::string name;
  Bounds bounds;  ///< Its centre becomes the origin.
  Material material;
  SymmetryGroup symmetry = {};  ///< About the centre of the bounds.
  double cell = 0.0022;         ///< Mesh resolution, metres.
  DistanceField field = {};
  Paint paint = {};
  std::vector<ConvexPart> parts = {};
  std::function<bool(const Eigen::Vector3d&)> telltale = {};  ///< Empty: nothing is.
};

/// Meshes and paints each shape.
std::vector<SimulatedObject> build_objects(const std::vector<Shape>& shapes, int num_threads);

std::vector<Shape> vessel_shapes();  ///< mug, bowl, bottle, can, cup, tube, funnel, plate
/// milk_carton, cereal_box, snack_box, spray_bottle, jug, cube, l_brick, stud_block, gear, banana
std::vector<Shape> solid_shapes();
/// pen, screwdriver, wrench, scissors, clamp, spatula, tin, battery, phone, remote, book, soap,
/// sponge, matchbox
std::vector<Shape> tool_shapes();

// Symmetries.
SymmetryGroup turning_z();            ///< Any angle about z.
SymmetryGroup turning_z_and_flip();   ///< And upside down.
SymmetryGroup cyclic_z(int order);    ///< Steps of 360/order degrees about z.
SymmetryGroup dihedral_z(int order);  ///< And half turns about x and the like.
SymmetryGroup octahedral();           ///< The 24 turns of a cube.

// Convex parts.
ConvexPart box_part(const Eigen::Vector3d& center, const Eigen::Vector3d& half_size);
ConvexPart capsule_part(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius_a,
                        double radius_b);
/// A convex polygon in (x, z), drawn along y over [-half_depth, half_depth].
ConvexPart prism_y_part(const Profile& polygon, double half_depth);
/// A solid of revolution about z as one frustum for each pair of (radius, height).
void add_solid_parts(const Profile& outline, std::vector<ConvexPart>& parts);
/// A thin wall of revolution: the polyline of its middle, (radius, height), and its thickness.
void add_shell_parts(const Profile& middle, double thickness, std::vector<ConvexPart>& parts);

// Colours.
/// A steady pseudo-random number in [0, 1) of a lattice point.
double lattice_noise(int x, int y, int z);
/// Smooth noise in [0, 1] whose features are about `scale` metres.
double smooth_noise(const Eigen::Vector3d& p, double scale);
/// 1 inside lines of something like print at (u, v) metres; letters are `size` metres high.
double print_pattern(double u, double v, double size);
Color mix(const Color& a, const Color& b, double t);

}  // namespace bpa::sim
