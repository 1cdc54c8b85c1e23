// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/io/options_yaml.hpp"
#include "idl/wire/cdr.hpp"

namespace bpa::server {
namespace {

using wire::rcl_interfaces::Parameter;
using wire::rcl_interfaces::ParameterDescriptor;
using wire::rcl_interfaces::ParameterType;
using wire::rcl_interfaces::ParameterValue;

/// One function of several.
template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;  // Clang 14 does not deduce it

std::uint8_t type_of(const Option& setting) {
  constexpr std::uint8_t kTypes[] = {ParameterType::kNotSet,     ParameterType::kBool,
                                     ParameterType::kInteger,    ParameterType::kDouble,
                                     ParameterType::kInteger,    ParameterType::kString,
                                     ParameterType::kStringArray};
  return kTypes[setting.value.index()];
}

ParameterValue value_of(const Option& setting) {
  ParameterValue value;
  value.type = type_of(setting);
  std::visit(
      Overloaded{
          [](std::monostate) {}, [&](const bool* field) { value.bool_value = *field; },
          [&](const double* field) { value.double_value = *field; },
          [&](const std::string* field) { value.string_value = *field; },
          [&](const std::vector<std::string>* field) { value.string_array_value = *field; },
          [&](const auto* integer) { value.integer_value = static_cast<std::int64_t>(*integer); }},
      setting.value);
  return value;
}

Status set_value(const Option& setting, const ParameterValue& value) {
  const bool widened =
      type_of(setting) == ParameterType::kDouble && value.type == ParameterType::kInteger;
  if (value.type != type_of(setting) && !widened) {
    return invalid_argument(setting.path + " is of type " + type_name(type_of(setting)) +
                            "; it cannot be set to one of type " + type_name(value.type));
  }
  bool fits = true;
  std::visit(Overloaded{[](std::monostate) {}, [&](bool* field) { *field = value.bool_value; },
                        [&](double* field) {
                          *field = widened ? static_cast<double>(value.integer_value)
                                           : value.double_value;
                        },
                        [&](std::string* field) { *field = value.string_value; },
                        [&](std::vector<std::string>* field) { *field = value.string_array_value; },
                        [&]<class Integer>(Integer* field) {
                          fits = std::in_range<Integer>(value.integer_value);
                          if (fits) *field = static_cast<Integer>(value.integer_value);
                        }},
             setting.value);
  if (fits) return {};
  return invalid_argument(setting.path + " is " + std::to_string(value.integer_value) +
                          "; it is out of range");
}

/// Every setting by the name of its parameter; the values point into `options`.
std::vector<Option> settings_of(ServerOptions& options) {
  std::vector<Option> settings = options_of(options);
  std::erase_if(settings, [](const Option& option) { return option.is_group(); });
  for (Option& setting : settings) {
    if (setting.value == Option::Value(&options.node.use_sim_time)) setting.path = kUseSimTime;
  }
  return settings;
}

std::optional<Option> find_setting(ServerOptions& options, const std::string& name) {
  for (Option& setting : settings_of(options)) {
    if (setting.path == name) return std::move(setting);
  }
  return std::nullopt;
}

bool is_read_only(const Option& setting) {
  return !setting.rule.runtime && !setting.path.starts_with("detector.");  // it is made anew
}

std::uint64_t levels(const std::string& name) {
  return static_cast<std::uint64_t>(std::count(name.begin(), name.end(), '.')) + 1;
}

}  // namespace

const char* type_name(std::uint8_t type) {
  constexpr const char* kNames[] = {"not set",      "bool",        "integer",    "double",
                                    "string",       "byte array",  "bool array", "integer array",
                                    "double array", "string array"};
  return type < std::size(kNames) ? kNames[type] : "unknown";
}

std::vector<Parameter> all_parameters(const ServerOptions& options) {
  std::vector<Parameter> parameters;
  ServerOptions copy = options;
  for (const Option& setting : settings_of(copy)) {
    parameters.push_back({setting.path, value_of(setting)});
  }
  return parameters;
}

ParameterValue parameter(const ServerOptions& options, const std::string& name) {
  ServerOptions copy = options;
  const auto setting = find_setting(copy, name);
  return setting ? value_of(*setting) : ParameterValue();
}

ParameterDescriptor describe_parameter(const std::string& name) {
  ParameterDescriptor descriptor;
  descriptor.name = name;
  ServerOptions options;
  const auto setting = find_setting(options, name);
  if (!setting) return descriptor;
  const FieldRule& rule = setting->rule;
  descriptor.type = type_of(*setting);
  descriptor.description = io::description_of(*setting);
  descriptor.read_only = is_read_only(*setting);
  if (!std::isfinite(rule.min) || !std::isfinite(rule.max)) return descriptor;
  if (descriptor.type == ParameterType::kInteger) {
    descriptor.integer_range.push_back(
        {static_cast<std::int64_t>(rule.min), static_cast<std::int64_t>(rule.max), 1});
  } else if (descriptor.type == ParameterType::kDouble) {
    descriptor.floating_point_range.push_back({rule.min, rule.max, 0});
  }
  return descriptor;
}

Status set_parameter(const Parameter& parameter, ServerOptions& options) {
  const auto setting = find_setting(options, parameter.name);
  if (!setting) {
    return Status(StatusCode::not_found, "there is no parameter " + parameter.name);
  }
  if (is_read_only(*setting)) {
    return Status(StatusCode::unsupported,
                  parameter.name + " is read-only: it is set when the server starts");
  }
  return set_value(*setting, parameter.value);
}

wire::rcl_interfaces::ListParametersResult list_parameters(const std::vector<std::string>& prefixes,
                                                           std::uint64_t depth) {
  wire::rcl_interfaces::ListParametersResult result;
  ServerOptions options;
  for (const Option& setting : settings_of(options)) {
    const std::string& name = setting.path;
    bool wanted = prefixes.empty() && (depth == 0 || levels(name) <= depth);
    for (const std::string& prefix : prefixes) {
      const bool below = name.rfind(prefix + ".", 0) == 0;
      const bool near = depth == 0 || levels(name) - levels(prefix) <= depth;
      wanted = wanted || name == prefix || (below && near);
    }
    if (!wanted) continue;
    result.names.push_back(name);
    const std::size_t dot = name.rfind('.');
    if (dot == std::string::npos) continue;
    const std::string group = name.substr(0, dot);
    if (result.prefixes.empty() || result.prefixes.back() != group) {
      result.prefixes.push_back(group);
    }
  }
  return result;
}

std::vector<Parameter> changed_parameters(const ServerOptions& before, const ServerOptions& after) {
  const std::vector<Parameter> old = all_parameters(before), now = all_parameters(after);
  std::vector<Parameter> changed;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (wire::encode(now[i]) != wire::encode(old[i])) changed.push_back(now[i]);
  }
  return changed;
}

}  // namespace bpa::server
