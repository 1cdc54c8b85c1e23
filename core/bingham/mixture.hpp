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
  /// The mode of highest density: from each component's mode uphill, the best end.
  Eigen::Quaterniond mode() const;
};

/// A component given as a log weight and an exponent that needs no normalisation: it stands for
/// exp(log_weight + qᵀ exponent q).
struct UnnormalizedBingham {
  double log_weight = 0;
  Eigen::Matrix4d exponent = Eigen::Matrix4d::Zero();
};

/// Normalises; components of relative weight below `smallest` are left out.
BinghamMixture normalize_mixture(const std::vector<UnnormalizedBingham>& components,
                                 double smallest = 1e-12);

/// The normalised product of densities, every component with every other.
BinghamMixture product(const BinghamMixture& a, const BinghamMixture& b);

/// At most `max_components` (at least 1): merges, again and again, the two whose replacement by the
/// Bingham of their joint scatter costs least in Kullback-Leibler divergence, as bounded by
/// Runnalls (2007): w1 KL(1 || merged) + w2 KL(2 || merged).
BinghamMixture reduce(const BinghamMixture& mixture, int max_components);

}  // namespace bpa
