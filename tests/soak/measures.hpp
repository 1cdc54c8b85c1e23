// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "tests/support/process_reading.hpp"

namespace bpa::soak {

using support::Reading;

/// The value below or at which `percent` of the values lie; 0 without values.
inline double percentile(std::vector<double> values, double percent) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const auto place = static_cast<std::size_t>(percent / 100 * static_cast<double>(values.size()));
  return values[std::min(place, values.size() - 1)];
}

/// One field of the readings from `begin` to `end`, seconds.
inline std::vector<double> during(const std::vector<Reading>& readings, double begin, double end,
                                  double Reading::*field) {
  std::vector<double> values;
  for (const Reading& reading : readings) {
    if (reading.seconds >= begin && reading.seconds <= end) values.push_back(reading.*field);
  }
  return values;
}

}  // namespace bpa::soak
