// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/bingham/bingham.hpp"

namespace bpa {

/// A weighted sum of Binghams: orientations that a view cannot decide between.
struct BinghamMixture {
  struct Component {
    double weight = 1;  ///< Positive; the weights of a mixture sum to 1.
    Bingham bingham;
  };
  std::vector<Component> components;

  double log_density(const Eigen::Quaterniond& q) const;
  Eigen::Matrix4d scatter() const;
  Eigen::Quaterniond sample(RandomStream& random) const;
};

}  // namespace bpa
