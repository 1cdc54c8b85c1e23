// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/cloud/point_cloud.hpp"
#include "core/geometry/symmetry.hpp"

namespace bpa::sim {

/// What a depth sensor with a projected pattern notices of a surface.
struct Material {
  double infrared = 0.7;  ///< Diffuse reflectance at 830 nm, in [0, 1]; below 0.2 is dark.
  double shine = 0.1;     ///< Mirror-like part, in [0, 1]; above 0.5 is shiny.
};

/// The corners of a convex body; its hull is what collides.
using ConvexPart = std::vector<Eigen::Vector3f>;

/// An object that can lie in a simulated scene.
struct SimulatedObject {
  std::string name;
  TriangleMesh mesh;  ///< Closed, coloured; metres.
  Material material;
  SymmetryGroup symmetry;         ///< Of the shape alone; colours may break it.
  std::vector<ConvexPart> parts;  ///< Together they fill the mesh, hollows left open.
  /// Vertices without which it looks the same from many sides, as those of a handle. Empty: none.
  std::vector<int> telltales = {};
};

/// Eighteen objects of a household, always the same: mug, bowl, bottle, can, cup, tube, funnel,
/// plate, milk_carton, cereal_box, snack_box, spray_bottle, jug, cube, l_brick, stud_block, gear,
/// banana. Upright along +z, the origin at the centre of the bounding box. Some 15 to 60 thousand
/// triangles each; about a second in all.
std::vector<SimulatedObject> household_objects(int num_threads = 0);

/// Fourteen things of a workshop and a desk, thin, flat, long or small: pen, screwdriver, wrench,
/// scissors, clamp, spatula, tin, battery, phone, remote, book, soap, sponge, matchbox.
std::vector<SimulatedObject> workshop_objects(int num_threads = 0);

/// Those of both that are named, in the order of the names; unknown names are left out.
std::vector<SimulatedObject> household_objects(const std::vector<std::string>& names,
                                               int num_threads = 0);

/// An object from a user's mesh, not empty, in its own frame; collides as its vertices' hull.
SimulatedObject object_from_mesh(std::string name, TriangleMesh mesh,
                                 const SymmetryGroup& symmetry = {});

/// The vertices that stand out of an upright vessel's wall, as those of a handle: the wall is the
/// circle about a vertical axis that most vertices are on, seen from above. Empty where no circle
/// has many, or what stands out is not on one side.
std::vector<int> protruding_vertices(const TriangleMesh& mesh);

/// The object as it is made, not as its model says: longer or shorter along each of its axes by a
/// normally distributed share of standard deviation `error`.
SimulatedObject made_inexactly(SimulatedObject object, double error, std::uint64_t seed);

/// An object of the same shape that is printed otherwise: a band with print on a ground, in three
/// random colours.
SimulatedObject printed_otherwise(SimulatedObject object, std::uint64_t seed);

/// Objects in abundance: those of the household and the workshop in turn, each with sizes along its
/// axes that differ by 15 % (standard deviation), and printed otherwise. Object i is the same
/// whatever `count` is; its name is that of its kind and the turn, as mug_1. The symmetries are
/// those of the original, which the sizes may break.
std::vector<SimulatedObject> varied_objects(int count, int num_threads = 0);

/// The largest distance between two vertices, metres.
double diameter(const TriangleMesh& mesh);

}  // namespace bpa::sim
