// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/components.hpp"

namespace bpa::score {

ScoreValues measure(Evidence& evidence, Round last) {
  ScoreValues values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ComponentType& type = kScoreComponents[i];
    values[i] = type.round <= last ? type.measure(evidence) : kNotKnown;
  }
  return values;
}

}  // namespace bpa::score
