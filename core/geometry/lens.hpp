// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera.hpp"

namespace bpa {

/// How a lens bends the normalised image plane.
struct Lens {
  bool equidistant = false;          ///< A fisheye: k1 k2 k3 k4 of the angle, as OpenCV's fisheye.
  std::vector<double> coefficients;  ///< As distort() takes them; empty: it does not bend.
};

/// A lens by the names that ROS and others have for its model; coefficients of zero are none. An
/// empty name: plumb_bob or rational_polynomial. Fails with invalid_argument on numbers that are
/// not finite, or more than the model has, and with unsupported on another model, by its name.
Result<Lens> lens_of(const std::string& model, std::vector<double> coefficients);

/// Where it shows the point (x, y).
Eigen::Vector2d distort(const Lens& lens, double x, double y);

}  // namespace bpa
