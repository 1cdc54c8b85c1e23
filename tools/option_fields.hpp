// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <sstream>
#include <string_view>

#include <CLI/CLI.hpp>

#include "core/base/options.hpp"

namespace bpa::cli {

/// One command line option for a field of an options struct.
struct OptionField {
  const char* option;  ///< Such as "--starts".
  std::string_view field;
};

/// Adds an option for each of these fields. Texts and ranges are those of visit_fields; validate()
/// checks the ranges when the command runs.
template <class Options>
void add_options(CLI::App& command, Options& options, std::initializer_list<OptionField> fields) {
  for (const OptionField& wanted : fields) {
    bool known = false;
    options.visit_fields([&](std::string_view name, auto& value, const FieldRule& rule) {
      if (name != wanted.field) return;
      known = true;
      std::ostringstream text;
      text << rule.description << " " << rule.min << " to " << rule.max << ".";
      command.add_option(wanted.option, value, text.str())->capture_default_str();
    });
    assert(known);
    static_cast<void>(known);
  }
}

}  // namespace bpa::cli
