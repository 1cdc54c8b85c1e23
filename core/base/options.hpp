// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/base/status.hpp"

// Options are trees of structs of defaults. A struct describes its fields and the structs inside of
// it once:
//
//   void visit_fields(auto&& visit) {
//     visit("max_range_m", max_range_m, {0.1, 20, "Surface further away is ignored."});
//   }
//   void visit_groups(auto&& visit) {
//     visit("refinement", refinement, "Gradient-based alignment.");
//   }
//
// Reading files, checks, printing, help texts and run-time parameters use these functions. Fields
// are bool, int, double, std::uint64_t, std::string and std::vector<std::string>.

namespace bpa {

/// The rule and the meaning of one field. `min` and `max` are inclusive; bools and texts ignore
/// them.
struct FieldRule {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  const char* description = "";
  bool runtime = false;  ///< May change while the program runs.
  /// Of a text: the values it may have, each followed by a space; empty for any text.
  std::string_view choices = {};
};

/// The same rule for a field that may change while the program runs.
constexpr FieldRule at_run_time(FieldRule rule) {
  rule.runtime = true;
  return rule;
}

/// One entry of a tree of options: a group (no value) or a field of a struct.
struct Option {
  using Value = std::variant<std::monostate, bool*, int*, double*, std::uint64_t*, std::string*,
                             std::vector<std::string>*>;
  std::string path;  ///< Such as "round_two.refinement.iterations".
  FieldRule rule;    ///< Of a group: its description alone.
  Value value;

  bool is_group() const { return std::holds_alternative<std::monostate>(value); }
};

namespace detail {
struct AnyVisitor {
  template <class... Arguments>
  void operator()(Arguments&&...) const {}
};
}  // namespace detail

/// Every group and field of a tree, in the order of its declarations, each group before its fields.
/// The values point into `options`.
template <class Options>
std::vector<Option> options_of(Options& options, const std::string& prefix = "") {
  std::vector<Option> out;
  if constexpr (requires { options.visit_fields(detail::AnyVisitor()); }) {
    options.visit_fields([&](const char* name, auto& value, const FieldRule& rule) {
      out.push_back({prefix + name, rule, &value});
    });
  }
  if constexpr (requires { options.visit_groups(detail::AnyVisitor()); }) {
    options.visit_groups([&](const char* name, auto& group, const char* description) {
      out.push_back({prefix + name, {.description = description}, std::monostate()});
      for (Option& option : options_of(group, prefix + name + "."))
        out.push_back(std::move(option));
    });
  }
  return out;
}

namespace detail {
inline Status validate_text(const std::string& path, const std::string& value,
                            std::string_view choices) {
  std::string listed;
  for (std::size_t i = 0; i < choices.size();) {
    const std::size_t end = choices.find(' ', i);
    const std::string_view choice = choices.substr(i, end - i);
    if (choice == value) return {};
    listed += (listed.empty() ? "" : ", ") + std::string(choice);
    i = end + 1;
  }
  if (choices.empty()) return {};
  return invalid_argument(path + " is \"" + value + "\"; it must be one of " + listed);
}
}  // namespace detail

/// Checks a number or text against its rule. The message names the field, its value and the rule.
inline Status validate(const Option& option) {
  return std::visit(
      [&](const auto& value) -> Status {
        using Value = std::remove_cvref_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, int*> || std::is_same_v<Value, double*> ||
                      std::is_same_v<Value, std::uint64_t*>) {
          const auto number = static_cast<double>(*value);
          if (number >= option.rule.min && number <= option.rule.max) return {};
          std::ostringstream text;
          text << option.path << " is " << number << "; it must be between " << option.rule.min
               << " and " << option.rule.max;
          return invalid_argument(text.str());
        } else if constexpr (std::is_same_v<Value, std::string*>) {
          return detail::validate_text(option.path, *value, option.rule.choices);
        }
        return {};
      },
      option.value);
}

/// Checks every field of a tree; the first problem.
template <class Options>
Status validate(const Options& options) {
  Options copy = options;
  for (const Option& option : options_of(copy)) {
    if (Status status = validate(option); !status.ok()) return status;
  }
  return {};
}

}  // namespace bpa
