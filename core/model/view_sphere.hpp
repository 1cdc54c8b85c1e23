// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/shared_array.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/geometry/pose.hpp"

namespace bpa {

constexpr float kMaxEdgeDistance = 0.1f;  ///< Edge distances are cut off here, metres.
constexpr int kNumViews = 66;  ///< Paper section III: 66 viewing angles across the view sphere.

/// What a camera far away in one direction sees of a model.
struct ModelView {
  Eigen::Vector3f direction;             ///< From the object to the camera, unit length.
  SharedArray<std::uint32_t> visible;    ///< Surface points that are seen, by index.
  SharedArray<float> edge_distance;      ///< For each visible point, how far the nearest range edge
                                         ///< is in the view plane, metres (paper section III); at
                                         ///< most kMaxEdgeDistance.
  SharedArray<std::uint32_t> edges;      ///< Those on a range edge, where the surface ends in this
                                         ///< view (paper section III).
  SharedArray<Eigen::Vector3f> outward;  ///< For each edge point, the unit direction across the
                                         ///< edge, away from the surface, in the view plane.
};

/// Rows: x and y of a view plane, and the `direction` to the camera (unit length).
Eigen::Matrix3f view_axes(const Eigen::Vector3f& direction);

/// 66 directions spread evenly over the sphere (a Fibonacci lattice).
std::array<Eigen::Vector3f, kNumViews> view_directions();

/// The view whose direction is nearest to `direction` (unit length, object to camera). Needs views.
const ModelView& nearest_view(const std::vector<ModelView>& views,
                              const Eigen::Vector3f& direction);

/// The view nearest to how a camera sees the object at `camera_from_object`. Needs views.
const ModelView& nearest_view(const std::vector<ModelView>& views,
                              const FastPose& camera_from_object);

/// Renders the points into a depth buffer of cells as large as `spacing` along each direction.
std::vector<ModelView> render_views(const PointCloud& surface, float spacing, int num_threads);

/// The same for one camera at `camera` (in the surface's frame, outside of it): its `direction` is
/// that from the middle of the points; distances are measured at the depth of the middle.
ModelView render_from(const PointCloud& surface, const Eigen::Vector3f& camera, float spacing);

}  // namespace bpa
