// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

#include "core/geometry/symmetry.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/model/object_model.hpp"

// How wrong a pose is, by the definitions of the BOP benchmark (Hodan et al. 2016, 2020) and of
// Hinterstoisser et al. 2012, and which estimate is right about which instance. `points` are the
// vertices of the object's mesh. Metres and pixels.

namespace bpa::eval {

using Points = std::vector<Eigen::Vector3f>;

/// The cost of a pair that cannot be matched.
constexpr double kNoMatch = std::numeric_limits<double>::infinity();

/// The larger of position error / position_m and orientation error / angle_rad, modulo the symmetry
/// (paper section VII): 0 to 1, and kNoMatch above 1.
double right_cost(const Pose& estimate, const Pose& truth, const SymmetryGroup& symmetry,
                  double position_m = kPoseTolerance_m, double angle_rad = kPoseTolerance_rad);

/// Whether an estimate is within the paper's tolerance of the truth, modulo the symmetry. A fast no
/// beyond 20 cm: symmetries are taken to move the object's origin by less than 17 cm.
bool is_right(const Pose& estimate, const Pose& truth, const SymmetryGroup& symmetry);

/// Whether a pose of a model (camera_from_object) is_right() about one of these instances.
bool is_right_about_any(const Pose& estimate, const ObjectModel& model,
                        const std::vector<io::BopInstance>& truth);

/// Greedy one-to-one matching, as BOP does it: estimates by falling score (by index where equal)
/// each take the free truth of the smallest cost below `limit`. costs[e][t] is kNoMatch where the
/// estimate is not correct for the truth. Returns the truth of each estimate, -1 for none.
std::vector<int> match_greedily(const std::vector<double>& scores,
                                const std::vector<std::vector<double>>& costs,
                                double limit = kNoMatch);

/// The discrete symmetries times the continuous one, in steps that move a vertex by at most
/// `max_step` diameters (BOP: 0.01, which makes ceil(π / 0.01) steps). The identity is first.
std::vector<Pose> discretised_symmetries(const SymmetryGroup& group, double max_step = 0.01);

/// ADD: mean distance of corresponding vertices.
double average_distance(const Points& points, const Pose& estimate, const Pose& truth);

/// ADD-S (ADI): mean distance from a vertex of the true object to the nearest vertex of the
/// estimated one. Of more than 2000 vertices every n-th is asked for, so that at most 2000 are.
double average_nearest_distance(const Points& points, const Pose& estimate, const Pose& truth);

/// Root mean squared distance of corresponding vertices; the smallest over the symmetries.
double rms_distance(const Points& points, const Pose& estimate, const Pose& truth,
                    const std::vector<Pose>& symmetries);

/// MSSD: the largest distance of corresponding vertices; the smallest of it over the symmetries.
double max_surface_distance(const Points& points, const Pose& estimate, const Pose& truth,
                            const std::vector<Pose>& symmetries);

/// MSPD: the same after projection, in pixels. Vertices behind the camera make it infinite.
double max_projection_distance(const Points& points, const Pose& estimate, const Pose& truth,
                               const std::vector<Pose>& symmetries, const Camera& camera);

/// The depth of a mesh at a pose: row-major, metres along z at pixel centres; 0 where there is
/// nothing. Triangles nearer than 1 cm are left out, both sides of the others are seen.
std::vector<float> render_depth(const TriangleMesh& mesh, const Pose& camera_from_object,
                                const Camera& camera);

/// BOP's ten tolerances and thresholds of correctness: 0.05, 0.1, ... 0.5.
constexpr std::array<double, 10> kBopThresholds = {0.05, 0.10, 0.15, 0.20, 0.25,
                                                   0.30, 0.35, 0.40, 0.45, 0.50};

/// VSD for tolerances kBopThresholds x diameter: the fraction of wrong pixels in the union of both
/// visible silhouettes. A pixel is wrong where the rendered distances differ by the tolerance or
/// more, or only one silhouette is visible. The three images are row-major depths in metres (0:
/// nothing): rendered at the estimate, rendered at the truth, and measured. Visible: at most
/// `delta` behind the measured surface, or no measurement.
std::array<double, 10> visible_surface_discrepancy(const std::vector<float>& depth_estimate,
                                                   const std::vector<float>& depth_truth,
                                                   const std::vector<float>& depth_measured,
                                                   const Camera& camera, double diameter,
                                                   double delta = 0.015);

}  // namespace bpa::eval
