// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/cloud/point_cloud.hpp"

// Solids as signed distance fields (metres; negative inside), and the closed mesh of their surface.
// The formulas are the customary ones (Hart 1996, "Sphere tracing"; Quilez, "Distance functions").

namespace bpa::sim {

/// The signed distance of a point; away from the surface, a number of its sign will do.
using DistanceField = std::function<double(const Eigen::Vector3d&)>;

/// The 2-D outline of a solid of revolution: radius and height of its corners, in order.
using Profile = std::vector<Eigen::Vector2d>;

/// A box centred at the origin whose edges are rounded by `rounding` (included in `half_size`).
double box_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& half_size, double rounding);
/// The same in the plane.
double rectangle_distance(const Eigen::Vector2d& p, const Eigen::Vector2d& half_size,
                          double rounding);
/// A cone frustum with spherical ends: radius `radius_a` at a, `radius_b` at b.
double capsule_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                        const Eigen::Vector3d& b, double radius_a, double radius_b);
/// A cylinder about the z axis, edges rounded by `rounding` (included in the sizes).
double cylinder_distance(const Eigen::Vector3d& p, double radius, double half_height,
                         double rounding);
/// A torus in the xz plane round `center`.
double torus_xz_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& center, double radius,
                         double thickness);
/// A closed polygon in the plane, corners in either order.
double polygon_distance(const Eigen::Vector2d& p, const Profile& corners);
/// The polygon over (-radius, radius) of a profile that starts and ends on the axis; give it, and
/// the point's (distance from the axis, height), to polygon_distance.
Profile mirrored(const Profile& profile);
/// The solid made by drawing a planar distance along an axis over [-half_height, half_height].
double extruded(double planar_distance, double height, double half_height, double rounding);

/// Union with the crease filled over about `blend`.
double smooth_union(double a, double b, double blend);
/// `a` without `b`, the crease filled over about `blend`.
double smooth_difference(double a, double b, double blend);

/// The surface of the field inside the box [low, high] as a closed mesh with outward normals. Dual
/// marching cubes (Nielson 2004) on a grid of `cell` metres. One vertex for each piece of surface
/// in a cell, moved onto the field's zero. Walls must be thicker than about 1.5 cells. The surface
/// must lie two cells inside the box.
TriangleMesh mesh_from_field(const DistanceField& field, const Eigen::Vector3d& low,
                             const Eigen::Vector3d& high, double cell);

}  // namespace bpa::sim
