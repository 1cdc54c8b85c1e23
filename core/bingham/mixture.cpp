// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/bingham/mixture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bpa {
double BinghamMixture::log_density(const Eigen::Quaterniond& q) const {
  double largest = -std::numeric_limits<double>::infinity();
  for (const Component& c : components) {
    largest = std::max(largest, std::log(c.weight) + c.bingham.log_density(q));
  }
  double sum = 0;
  for (const Component& c : components) {
    sum += std::exp(std::log(c.weight) + c.bingham.log_density(q) - largest);
  }
  return largest + std::log(sum);
}

Eigen::Matrix4d BinghamMixture::scatter() const {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (const Component& c : components) sum += c.weight * c.bingham.scatter();
  return sum;
}

Eigen::Quaterniond BinghamMixture::sample(RandomStream& random) const {
  double left = random.uniform();
  for (const Component& c : components) {
    left -= c.weight;
    if (left < 0) return c.bingham.sample(random);
  }
  return components.empty() ? Bingham().sample(random) : components.back().bingham.sample(random);
}

}  // namespace bpa
