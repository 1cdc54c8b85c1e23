// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace bpa {

/// One number or switch that a search ran with.
struct PlanEntry {
  std::string name;    ///< Such as "check.max_in_library"; a setting has its own name.
  std::string value;   ///< As in YAML.
  std::string reason;  ///< "default", "setting", or the rule that made it.
};

}  // namespace bpa
