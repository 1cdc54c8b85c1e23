// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/depth_unit.hpp"

#include <cmath>

#include "core/base/concat.hpp"
#include "core/base/median.hpp"

namespace bpa {

std::string to_metres(std::vector<float>& depths) {
  constexpr std::size_t kStep = 13, kMany = 10000;  // no divisor of usual widths
  std::vector<float> some;
  const std::size_t step = depths.size() > kMany ? kStep : 1;
  for (std::size_t i = 0; i < depths.size(); i += step) {
    if (depths[i] > 0 && std::isfinite(depths[i])) some.push_back(depths[i]);
  }
  const double middle = some.empty() ? 0 : static_cast<double>(median(some));
  if (middle <= kMillimetresFrom) return {};
  for (float& z : depths) z *= 0.001f;
  return concat("depth is taken for millimetres: its median is ", fixed(middle, 0));
}

}  // namespace bpa
