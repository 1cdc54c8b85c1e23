// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/status.hpp"

// Options are trees of structs of defaults. A macro declares a plain member and describes it: name,
// default, range and sentence stand in one place.
//
//   struct CameraOptions {
//     BPA_OPTION(double, max_range_m, 2.5, (0.1, 20), "Surface further away is ignored, metres.");
//     BPA_OPTION(int, queue, 1, (1, 100).at_run_time(), "Frames that may wait.");
//     BPA_OPTION(std::string, mode, "raw", ("raw compressed "), "How images are sent.");
//     BPA_OPTION(bool, color, true, (), "Take colour images beside depth.");
//     BPA_GROUP(RefinementOptions, refinement, "Gradient-based alignment.") = {4, 160};
//     int num_threads = 0;  // No option: only code sets it.
//   };
//
// Files, checks, printing, help texts and run-time parameters use options_of().

/// A member `type name = value` that is an option, with the arguments of its FieldRule.
#define BPA_OPTION(type, name, value, rule, description) \
  BPA_NAMED_OPTION(#name, type, name, value, rule, description)

/// The same where users know it by another name, `path`.
#define BPA_NAMED_OPTION(path, type, name, value, rule, description) \
  BPA_LISTED(field(path, &name, ::bpa::FieldRule rule, description)) type name = value

/// A member `type name` that is a group of options. Defaults of its own may follow.
#define BPA_GROUP(type, name, description) BPA_LISTED(group(#name, name, description)) type name

/// A member `type name` whose options are listed as the struct's own.
#define BPA_INLINE_GROUP(type, name) BPA_LISTED(list(name)) type name

/// Lists the options of the base class `type` here.
#define BPA_BASE_OPTIONS(type) BPA_LISTED(list(static_cast<type&>(*this)))

/// These functions overload by the line of their macro; OptionList::list() finds them in order.
#define BPA_LISTED(entry)                                                          \
  ::bpa::detail::Line<__LINE__> list_option(::bpa::detail::Line<__LINE__>,         \
                                            ::bpa::detail::OptionList& bpa_list) { \
    bpa_list.entry;                                                                \
    return {};                                                                     \
  }

namespace bpa {

/// The rule of one field. `min` and `max` are inclusive; bools and texts ignore them.
struct FieldRule {
  constexpr FieldRule() = default;
  constexpr FieldRule(double lowest, double highest) : min(lowest), max(highest) {}
  constexpr explicit FieldRule(std::string_view values) : choices(values) {}

  /// The same rule for a field that may change while the program runs.
  constexpr FieldRule at_run_time() const {
    FieldRule rule = *this;
    rule.runtime = true;
    return rule;
  }

  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool runtime = false;
  /// Of a text: the values it may have, each followed by a space; empty for any text.
  std::string_view choices = {};
};

/// One entry of a tree of options: a group (no value) or a field of a struct.
struct Option {
  using Value = std::variant<std::monostate, bool*, int*, double*, std::uint64_t*, std::string*,
                             std::vector<std::string>*>;
  std::string path;  ///< Such as "round_two.refinement.iterations".
  const char* description;
  FieldRule rule;
  Value value;

  bool is_group() const { return std::holds_alternative<std::monostate>(value); }
};

/// The fields of a struct in the order of their declarations, then its groups, each before what is
/// in it. The values point into `options`.
template <class Options>
std::vector<Option> options_of(Options& options);

namespace detail {
constexpr int kLastLine = 600;  ///< No file is longer (tests/style/sources.py).

/// Of two overloads, the one for the later line wins.
template <int kLine>
struct Line : Line<kLine - 1> {
  static_assert(kLine <= kLastLine);
  static constexpr int kBefore = kLine - 1;
};
template <>
struct Line<0> {};

struct OptionList {
  std::vector<Option> fields, groups;

  void field(const char* name, Option::Value value, FieldRule rule, const char* description) {
    fields.push_back({name, description, rule, value});
  }

  void group(const std::string& name, auto& options, const char* description) {
    groups.push_back({name, description, {}, {}});
    for (Option& option : options_of(options)) {
      option.path = name + "." + option.path;
      groups.push_back(std::move(option));
    }
  }

  /// What is declared up to a line.
  template <int kUpTo = kLastLine, class Options>
  void list(Options& options) {
    if constexpr (requires { options.list_option(Line<kUpTo>(), *this); }) {
      using Last = decltype(options.list_option(Line<kUpTo>(), *this));
      list<Last::kBefore>(options);
      options.list_option(Last(), *this);
    }
  }
};
}  // namespace detail

template <class Options>
std::vector<Option> options_of(Options& options) {
  detail::OptionList list;
  list.list(options);
  list.fields.insert(list.fields.end(), list.groups.begin(), list.groups.end());
  return std::move(list.fields);
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
