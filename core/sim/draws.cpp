// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/private/draws.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace bpa::sim {

namespace {

using std::numbers::pi;

// Uniform over all orientations (Shoemake 1992).
Eigen::Quaterniond random_rotation(RandomStream& random) {
  const double u = random.uniform(), v = 2 * pi * random.uniform(), w = 2 * pi * random.uniform();
  const double a = std::sqrt(1 - u), b = std::sqrt(u);
  return {a * std::sin(v), a * std::cos(v), b * std::sin(w), b * std::cos(w)};
}

}  // namespace

Eigen::Quaterniond turned(RandomStream& random) {
  return rotation_from_vector(random.uniform(-pi, pi) * Eigen::Vector3d::UnitZ());
}

// Some household objects are put down, the others tumble.
Eigen::Quaterniond start_rotation(RandomStream& random) {
  constexpr double kUpright = 0.3;
  return random.uniform() < kUpright ? turned(random) : random_rotation(random);
}

std::vector<int> chosen_without_repetition(int count, int from, RandomStream& random) {
  count = std::min(count, from);
  std::vector<int> all(from);
  std::iota(all.begin(), all.end(), 0);
  for (int i = 0; i < count; ++i) std::swap(all[i], all[i + random.index(from - i)]);
  all.resize(count);
  return all;
}

Shading draw_shading(RandomStream& random) {
  Shading shading;
  shading.lights.clear();
  for (int i = 0; i < 2; ++i) {
    const double angle = 2 * pi * random.uniform(), reach = random.uniform(0.3, 1.6);
    const double height = random.uniform(1.4, 2.2);
    shading.lights.push_back(
        {{reach * std::cos(angle), reach * std::sin(angle), height}, random.uniform(0.25, 0.5)});
  }
  shading.ambient = random.uniform(0.35, 0.55);
  return shading;
}

}  // namespace bpa::sim
