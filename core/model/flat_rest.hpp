// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace bpa {

/// A way in which a thin object lies on a plane. Object frame, metres.
struct FlatRest {
  Eigen::Vector3f up;      ///< Away from the plane, unit length.
  Eigen::Vector3f axis;    ///< The longest direction of what is seen from above, unit length.
  Eigen::Vector3f centre;  ///< On the plane, in the middle of what is seen from above.
  float length = 0;        ///< Of the rectangle of the same spread.
  float width = 0;
};

/// The ways in which the object lies stably and not higher than 5 cm and 0.4 of its length: local
/// minima of the height of its middle over all directions. At most six; none for thick objects.
std::vector<FlatRest> flat_rests(std::span<const Eigen::Vector3f> surface);

/// The rectangle with the spread of points in a plane that `up` stands on.
struct FlatExtent {
  Eigen::Vector3f middle, axis;  ///< `middle` is the points' mean.
  float length = 0, width = 0;   ///< Metres.
};
FlatExtent flat_extent(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& up);

}  // namespace bpa
