// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <sstream>
#include <string>
#include <type_traits>

#include "core/base/status.hpp"

// Options are structs of defaults. Each one describes its fields once, in a
//
//   template <class Visitor> void visit_fields(Visitor&& visit) {
//     visit("max_range_m", max_range_m, {0.1, 20.0, "Points further away than this are ignored."});
//   }
//
// member, and reading files, validation, help texts and run-time parameters all use that.

namespace bpa {

/// The rule and the meaning of one field. `min` and `max` are inclusive; bools and strings ignore
/// them.
struct FieldRule {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  const char* description = "";
  bool runtime = false;  ///< May change while the program runs.
};

/// The same rule for a field that may change while the program runs.
constexpr FieldRule at_run_time(FieldRule rule) {
  rule.runtime = true;
  return rule;
}

/// Checks every field of an options struct against its rule. The message names the first field that
/// breaks it, its value and the rule.
template <class Options>
Status validate(const Options& options) {
  Status status;
  Options copy = options;
  copy.visit_fields([&status](const char* name, auto& value, const FieldRule& rule) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
      const double number = static_cast<double>(value);
      if (status.ok() && !(number >= rule.min && number <= rule.max)) {
        std::ostringstream text;
        text << name << " is " << number << "; it must be between " << rule.min << " and "
             << rule.max;
        status = invalid_argument(text.str());
      }
    }
  });
  return status;
}

}  // namespace bpa
