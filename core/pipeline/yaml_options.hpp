// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "core/base/options.hpp"

namespace bpa {

/// "FILE:LINE: " of a YAML node.
inline std::string yaml_place(const std::string& path, const YAML::Node& node) {
  return path + ":" + std::to_string(node.Mark().line + 1) + ": ";
}

/// Sets the fields of an options struct that the YAML map names. Unknown keys, values of another
/// kind and values outside their rule are errors that name file, line, key and rule. An empty
/// document changes nothing.
template <class Options>
Status read_yaml_options(const YAML::Node& map, const std::string& path, Options& options) {
  if (!map || map.IsNull()) return {};
  if (!map.IsMap()) {
    return invalid_argument(yaml_place(path, map) + "expected a map of \"key: value\" lines");
  }
  for (const auto& entry : map) {
    if (!entry.first.IsScalar()) {
      return invalid_argument(yaml_place(path, entry.first) +
                              "expected a map of \"key: value\" lines");
    }
    const auto key = entry.first.as<std::string>();
    bool known = false;
    std::string names;
    Status status;
    options.visit_fields([&](const char* name, auto& value, const FieldRule&) {
      names += names.empty() ? name : std::string(", ") + name;
      if (key != name) return;
      known = true;
      using Value = std::decay_t<decltype(value)>;
      try {
        value = entry.second.template as<Value>();
      } catch (const YAML::Exception&) {
        const char* kind = std::is_same_v<Value, bool>       ? "true or false"
                           : std::is_integral_v<Value>       ? "a whole number"
                           : std::is_floating_point_v<Value> ? "a number"
                                                             : "a text";
        status = invalid_argument(yaml_place(path, entry.first) + key + " must be " + kind);
      }
    });
    if (!known) {
      return invalid_argument(yaml_place(path, entry.first) + "unknown key \"" + key +
                              "\"; known keys are " + names);
    }
    if (!status.ok()) return status;
    // What came before was valid: whatever breaks its rule now is this key.
    if (Status broken = validate(options); !broken.ok()) {
      return Status(broken.code, yaml_place(path, entry.first) + broken.message);
    }
  }
  return {};
}

}  // namespace bpa
