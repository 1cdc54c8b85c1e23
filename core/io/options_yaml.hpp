// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/options.hpp"

// Trees of options as YAML files. Problems, unknown keys too, name file, line, key, value and rule.

namespace bpa::io {

/// How options are read.
struct OptionsReading {
  std::vector<Option> options;  ///< Where the values go; see options_of().
  /// Below this path, a field may be named without the groups it is in, if only one has the name.
  std::string short_names_below = "-";
  std::function<Status()> check;  ///< Run after each value that was set; may be empty.
};

/// Sets the fields that a YAML file names; the others keep their values. An empty file changes
/// nothing. Fails with not_found, or with invalid_argument after setting some.
Status read_options(const std::string& path, const OptionsReading& reading);

/// Sets one field from text such as "queue.requests=4".
Status set_option(const std::string& assignment, const OptionsReading& reading);

/// The value as YAML, exact; empty of a group.
std::string value_text(const Option& option);

/// The options as a YAML file, with description and rule in comments; # before values if `hidden`.
std::string options_yaml(const std::vector<Option>& options, bool hidden = false);

/// What it is, and of a text what it may be.
std::string description_of(const Option& option);

}  // namespace bpa::io
