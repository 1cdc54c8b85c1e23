// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace bpa::doctor {

enum class Severity {
  warning,  ///< Detection works, but finds less or is less exact.
  error,    ///< Detection cannot work.
};

/// Something wrong with what detection is given, for people.
struct Finding {
  Severity severity = Severity::warning;
  std::string what;    ///< What is wrong, one clause. The same for the same trouble.
  std::string why;     ///< What was measured, and what is right.
  std::string remedy;  ///< What to do.
};

using Findings = std::vector<Finding>;

}  // namespace bpa::doctor
