// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "idl/wire/cdr.hpp"

namespace bpa::server {
namespace {

using wire::rcl_interfaces::Parameter;
using wire::rcl_interfaces::ParameterDescriptor;
using wire::rcl_interfaces::ParameterType;
using wire::rcl_interfaces::ParameterValue;

template <class T>
constexpr std::uint8_t type_of() {
  if constexpr (std::is_same_v<T, bool>) return ParameterType::kBool;
  if constexpr (std::is_integral_v<T>) return ParameterType::kInteger;
  if constexpr (std::is_floating_point_v<T>) return ParameterType::kDouble;
  if constexpr (std::is_same_v<T, std::string>) return ParameterType::kString;
  return ParameterType::kStringArray;
}

const char* type_name(std::uint8_t type) {
  constexpr const char* kNames[] = {"not set",      "bool",        "integer",    "double",
                                    "string",       "byte array",  "bool array", "integer array",
                                    "double array", "string array"};
  return type < std::size(kNames) ? kNames[type] : "unknown";
}

template <class T>
ParameterValue to_value(const T& field) {
  ParameterValue value;
  value.type = type_of<T>();
  if constexpr (std::is_same_v<T, bool>) {
    value.bool_value = field;
  } else if constexpr (std::is_integral_v<T>) {
    value.integer_value = static_cast<std::int64_t>(field);
  } else if constexpr (std::is_floating_point_v<T>) {
    value.double_value = static_cast<double>(field);
  } else if constexpr (std::is_same_v<T, std::string>) {
    value.string_value = field;
  } else {
    value.string_array_value = field;
  }
  return value;
}

/// False when the integer is none that the field can hold.
template <class T>
bool fits(std::int64_t value) {
  if constexpr (std::is_unsigned_v<T>) {
    return value >= 0 &&
           static_cast<std::uint64_t>(value) <= std::uint64_t{std::numeric_limits<T>::max()};
  } else {
    return value >= std::numeric_limits<T>::min() && value <= std::numeric_limits<T>::max();
  }
}

template <class T>
Status from_value(const std::string& name, const ParameterValue& value, T& field) {
  const bool widened = std::is_floating_point_v<T> && value.type == ParameterType::kInteger;
  if (value.type != type_of<T>() && !widened) {
    return invalid_argument(name + " is of type " + type_name(type_of<T>()) +
                            "; it cannot be set to one of type " + type_name(value.type));
  }
  if constexpr (std::is_same_v<T, bool>) {
    field = value.bool_value;
  } else if constexpr (std::is_integral_v<T>) {
    if (!fits<T>(value.integer_value)) {
      return invalid_argument(name + " is " + std::to_string(value.integer_value) +
                              "; it is out of range");
    }
    field = static_cast<T>(value.integer_value);
  } else if constexpr (std::is_floating_point_v<T>) {
    field = static_cast<T>(widened ? static_cast<double>(value.integer_value) : value.double_value);
  } else if constexpr (std::is_same_v<T, std::string>) {
    field = value.string_value;
  } else {
    field = value.string_array_value;
  }
  return {};
}

/// Calls visit(full name, field, rule) for every setting.
template <class Visit>
void for_each_setting(ServerOptions& options, Visit visit) {
  for (const Option& option : options_of(options)) {
    std::visit(
        [&](const auto& value) {
          if constexpr (!std::is_same_v<std::remove_cvref_t<decltype(value)>, std::monostate>) {
            visit(option.path, *value, option.rule);
          }
        },
        option.value);
  }
}

bool is_read_only(const std::string& name, const FieldRule& rule) {
  return !rule.runtime && name.rfind("detector.", 0) != 0;  // the detector is made anew
}

template <class T>
ParameterDescriptor describe(const std::string& name, const T&, const FieldRule& rule) {
  ParameterDescriptor descriptor;
  descriptor.name = name;
  descriptor.type = type_of<T>();
  descriptor.description = rule.description;
  descriptor.read_only = is_read_only(name, rule);
  const bool bounded = std::isfinite(rule.min) && std::isfinite(rule.max);
  if constexpr (std::is_same_v<T, bool>) {
  } else if constexpr (std::is_integral_v<T>) {
    if (bounded) {
      descriptor.integer_range.push_back(
          {static_cast<std::int64_t>(rule.min), static_cast<std::int64_t>(rule.max), 1});
    }
  } else if constexpr (std::is_floating_point_v<T>) {
    if (bounded) descriptor.floating_point_range.push_back({rule.min, rule.max, 0});
  }
  return descriptor;
}

std::uint64_t levels(const std::string& name) {
  return static_cast<std::uint64_t>(std::count(name.begin(), name.end(), '.')) + 1;
}

}  // namespace

std::vector<Parameter> all_parameters(const ServerOptions& options) {
  std::vector<Parameter> parameters;
  ServerOptions copy = options;
  for_each_setting(copy, [&](const std::string& name, auto& field, const FieldRule&) {
    parameters.push_back({name, to_value(field)});
  });
  return parameters;
}

ParameterValue parameter(const ServerOptions& options, const std::string& name) {
  ParameterValue value;
  ServerOptions copy = options;
  for_each_setting(copy, [&](const std::string& one, auto& field, const FieldRule&) {
    if (one == name) value = to_value(field);
  });
  return value;
}

ParameterDescriptor describe_parameter(const std::string& name) {
  ParameterDescriptor descriptor;
  descriptor.name = name;
  ServerOptions options;
  for_each_setting(options, [&](const std::string& one, auto& field, const FieldRule& rule) {
    if (one == name) descriptor = describe(name, field, rule);
  });
  return descriptor;
}

Status set_parameter(const Parameter& parameter, ServerOptions& options) {
  Status status(StatusCode::not_found, "there is no parameter " + parameter.name);
  for_each_setting(options, [&](const std::string& name, auto& field, const FieldRule& rule) {
    if (name != parameter.name) return;
    status = is_read_only(name, rule)
                 ? Status(StatusCode::unsupported,
                          name + " is read-only: it is set when the server starts")
                 : from_value(name, parameter.value, field);
  });
  return status;
}

wire::rcl_interfaces::ListParametersResult list_parameters(const std::vector<std::string>& prefixes,
                                                           std::uint64_t depth) {
  wire::rcl_interfaces::ListParametersResult result;
  ServerOptions options;
  for_each_setting(options, [&](const std::string& name, auto&, const FieldRule&) {
    bool wanted = prefixes.empty() && (depth == 0 || levels(name) <= depth);
    for (const std::string& prefix : prefixes) {
      const bool below = name.rfind(prefix + ".", 0) == 0;
      const bool near = depth == 0 || levels(name) - levels(prefix) <= depth;
      wanted = wanted || name == prefix || (below && near);
    }
    if (!wanted) return;
    result.names.push_back(name);
    const std::string group = name.substr(0, name.rfind('.'));
    if (result.prefixes.empty() || result.prefixes.back() != group) {
      result.prefixes.push_back(group);
    }
  });
  return result;
}

std::vector<Parameter> changed_parameters(const ServerOptions& before, const ServerOptions& after) {
  std::vector<Parameter> changed = all_parameters(after);
  const std::vector<Parameter> old = all_parameters(before);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < changed.size(); ++i) {
    if (wire::encode(changed[i]) != wire::encode(old[i])) changed[kept++] = changed[i];
  }
  changed.resize(kept);
  return changed;
}

}  // namespace bpa::server
