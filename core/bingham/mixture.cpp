// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/bingham/mixture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/bingham/fit.hpp"
#include "core/bingham/normalizer.hpp"

namespace bpa {
namespace {

using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector4d;
using Component = BinghamMixture::Component;

// One step of ascent: the exponents weighted by their components' shares at q make a quadratic form
// that touches the log density at q from below, so its mode is not lower.
Quaterniond climb(const BinghamMixture& mixture, Quaterniond q) {
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double log_density = mixture.log_density(q);
    Matrix4d exponent = Matrix4d::Zero();
    for (const Component& c : mixture.components) {
      exponent +=
          c.weight * std::exp(c.bingham.log_density(q) - log_density) * c.bingham.exponent();
    }
    const Vector4d v = dominant_eigenvector(exponent);
    const Quaterniond next(v[0], v[1], v[2], v[3]);
    const bool done = 1 - std::abs(next.dot(q)) < 1e-15;
    q = next;
    if (done) break;
  }
  return q;
}

Component merge(const Component& a, const Component& b) {
  const double weight = a.weight + b.weight;
  const Matrix4d scatter =
      (a.weight * a.bingham.scatter() + b.weight * b.bingham.scatter()) / weight;
  return {weight, fit_bingham(scatter)};
}

double merging_cost(const Component& a, const Component& b, const Component& merged) {
  return a.weight * kl_divergence(a.bingham, merged.bingham) +
         b.weight * kl_divergence(b.bingham, merged.bingham);
}

}  // namespace

double BinghamMixture::log_density(const Quaterniond& q) const {
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

Matrix4d BinghamMixture::scatter() const {
  Matrix4d sum = Matrix4d::Zero();
  for (const Component& c : components) sum += c.weight * c.bingham.scatter();
  return sum;
}

Quaterniond BinghamMixture::sample(RandomStream& random) const {
  double left = random.uniform();
  for (const Component& c : components) {
    left -= c.weight;
    if (left < 0) return c.bingham.sample(random);
  }
  return components.empty() ? Bingham().sample(random) : components.back().bingham.sample(random);
}

Quaterniond BinghamMixture::mode() const {
  Quaterniond best = Quaterniond::Identity();
  double highest = -std::numeric_limits<double>::infinity();
  for (const Component& c : components) {
    const Quaterniond q = climb(*this, c.bingham.mode());
    const double height = log_density(q);
    if (height > highest) {
      highest = height;
      best = q;
    }
  }
  return best;
}

BinghamMixture normalize_mixture(const std::vector<UnnormalizedBingham>& components,
                                 double smallest) {
  std::vector<double> log_masses;
  double largest = -std::numeric_limits<double>::infinity();
  for (const UnnormalizedBingham& c : components) {
    const Vector4d lambda = symmetric_eigen(c.exponent).values;
    log_masses.push_back(c.log_weight + bingham_log_normalizer(lambda));
    largest = std::max(largest, log_masses.back());
  }
  BinghamMixture result;
  double total = 0;
  for (std::size_t i = 0; i < components.size(); ++i) {
    const double weight = std::exp(log_masses[i] - largest);
    if (weight < smallest) continue;
    total += weight;
    result.components.push_back({weight, Bingham::from_exponent(components[i].exponent)});
  }
  for (Component& c : result.components) c.weight /= total;
  return result;
}

BinghamMixture product(const BinghamMixture& a, const BinghamMixture& b) {
  std::vector<UnnormalizedBingham> products;
  for (const Component& x : a.components) {
    for (const Component& y : b.components) {
      const double log_weight = std::log(x.weight) - x.bingham.log_normalizer() +
                                std::log(y.weight) - y.bingham.log_normalizer();
      products.push_back({log_weight, x.bingham.exponent() + y.bingham.exponent()});
    }
  }
  return normalize_mixture(products);
}

BinghamMixture reduce(const BinghamMixture& mixture, int max_components) {
  BinghamMixture result = mixture;
  std::vector<Component>& c = result.components;
  const std::size_t limit = static_cast<std::size_t>(std::max(1, max_components));
  while (c.size() > limit) {
    std::size_t best_i = 0, best_j = 1;
    double least = std::numeric_limits<double>::infinity();
    Component best;
    for (std::size_t i = 0; i < c.size(); ++i) {
      for (std::size_t j = i + 1; j < c.size(); ++j) {
        const Component merged = merge(c[i], c[j]);
        const double cost = merging_cost(c[i], c[j], merged);
        if (cost < least) {
          least = cost;
          best_i = i;
          best_j = j;
          best = merged;
        }
      }
    }
    c[best_i] = best;
    c.erase(c.begin() + static_cast<std::ptrdiff_t>(best_j));
  }
  return result;
}

}  // namespace bpa
