// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/match_color.hpp"

#include <cmath>

#include "core/cloud/cielab.hpp"

namespace bpa {

MatchColor match_color(const Eigen::Vector3f& lab) {
  const Eigen::Array3f roots = light_roots(lab);
  return {std::log(roots[1]), 500 * roots[0] / roots[1], 200 * roots[2] / roots[1], roots[1]};
}

}  // namespace bpa
