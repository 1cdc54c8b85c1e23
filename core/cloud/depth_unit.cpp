// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/depth_unit.hpp"

#include <cmath>

#include "core/base/concat.hpp"
#include "core/base/median.hpp"

namespace bpa {

std::optional<double> some_median(const std::vector<float>& depths) {
  constexpr std::size_t kStep = 13;  // no divisor of usual widths
  std::vector<float> some;
  for (std::size_t i = 0; i<depths.size(); i += depths.size()> 10000 ? kStep : 1) {
    if (depths[i] > 0 && std::isfinite(depths[i])) some.push_back(depths[i]);
  }
  if (some.empty()) return std::nullopt;
  return static_cast<double>(median(some));
}

std::string millimetre_note(double median) {
  return concat("depth is taken for millimetres: its median is ", fixed(median, 0));
}

std::string to_metres(std::vector<float>& depths) {
  const auto median = some_median(depths);
  if (!median || *median <= kMillimetresFrom) return {};
  for (float& z : depths) z *= 0.001f;
  return millimetre_note(*median);
}

}  // namespace bpa
