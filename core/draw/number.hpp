// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

namespace bpa::draw {

/// "1.25" for (1.25, 2); "not known" for NaN. `digits` behind the point, 0 to 9.
inline std::string fixed(double value, int digits) {
  if (std::isnan(value)) return "not known";
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

}  // namespace bpa::draw
