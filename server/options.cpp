// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/options.hpp"

#include <filesystem>
#include <iomanip>
#include <sstream>
#include <string_view>
#include <type_traits>

#include <yaml-cpp/yaml.h>

namespace bpa::server {
namespace {

template <class T>
const char* kind_of() {
  if constexpr (std::is_same_v<T, bool>) return "true or false";
  if constexpr (std::is_integral_v<T>) return "a whole number";
  if constexpr (std::is_floating_point_v<T>) return "a number";
  if constexpr (std::is_same_v<T, std::string>) return "a text";
  return "a list of texts, such as [a, b]";
}

std::string one_line(const YAML::Node& node) {
  YAML::Emitter text;
  text << YAML::Flow << node;
  return text.c_str();
}

/// Visits the fields of one group and sets the one called `key` from `node`.
class FieldSetter {
 public:
  FieldSetter(const std::string& key, const YAML::Node& node) : key_(key), node_(node) {}

  template <class T>
  void operator()(const char* name, T& value, const FieldRule&) {
    if (key_ != name) return;
    found_ = true;
    T read{};
    if (convert(read)) {
      value = std::move(read);
    } else {
      problem_ = "is " + one_line(node_) + "; it must be " + kind_of<T>();
    }
  }
  bool found() const { return found_; }
  const std::string& problem() const { return problem_; }

 private:
  template <class T>
  bool convert(T& value) const {
    if constexpr (std::is_same_v<T, std::string>) {
      if (node_.IsNull()) return true;  // `key:` with nothing after it switches a topic off
      if (!node_.IsScalar()) return false;
    }
    if constexpr (std::is_same_v<T, std::vector<std::string>>) {
      if (node_.IsNull()) return true;
    }
    return YAML::convert<T>::decode(node_, value);
  }

  const std::string& key_;
  const YAML::Node& node_;
  bool found_ = false;
  std::string problem_;
};

/// What goes wrong with group.key, or an empty text.
std::string set_field(const std::string& group_name, const std::string& key, const YAML::Node& node,
                      ServerOptions& options) {
  bool group_found = false;
  std::string problem;
  options.visit_groups([&](const char* name, auto& group, const char*) {
    if (group_name != name) return;
    group_found = true;
    FieldSetter setter(key, node);
    group.visit_fields(setter);
    if (!setter.found()) {
      problem = std::string("unknown key ") + group_name + "." + key + "; its keys are";
      group.visit_fields(
          [&](const char* known, auto&, const FieldRule&) { (problem += " ") += known; });
    } else if (!setter.problem().empty()) {
      problem = group_name;
      ((problem += "." + key) += " ") += setter.problem();
    }
  });
  if (group_found) return problem;
  problem = "unknown key " + group_name + "; the keys are";
  options.visit_groups([&](const char* known, auto&, const char*) { (problem += " ") += known; });
  return problem;
}

Status at_line(const std::string& path, const YAML::Mark& mark, const std::string& problem) {
  return invalid_argument(path + ":" + std::to_string(mark.line + 1) + ": " + problem);
}

Status apply_file(const std::string& path, const YAML::Node& root, ServerOptions& options) {
  if (root.IsNull()) return {};
  if (!root.IsMap()) return at_line(path, root.Mark(), "the file must hold \"group:\" sections");
  for (const auto& section : root) {
    const auto group = section.first.as<std::string>("");
    if (section.second.IsNull()) continue;
    if (!section.second.IsMap()) {
      return at_line(path, section.first.Mark(), group + " must hold \"key: value\" lines");
    }
    for (const auto& entry : section.second) {
      const auto key = entry.first.as<std::string>("");
      ServerOptions changed = options;
      const std::string problem = set_field(group, key, entry.second, changed);
      if (!problem.empty()) return at_line(path, entry.first.Mark(), problem);
      if (Status status = validate(changed); !status.ok()) {
        return at_line(path, entry.first.Mark(), status.message);
      }
      options = changed;
    }
  }
  return {};
}

Status check_choice(const char* field, const std::string& value,
                    std::initializer_list<const char*> choices) {
  std::string rule;
  for (const char* choice : choices) {
    if (value == choice) return {};
    (rule += rule.empty() ? "" : ", ") += choice;
  }
  return invalid_argument(std::string(field) + " is \"" + value + "\"; it must be one of " + rule);
}

void write_value(std::ostream& out, const std::string& value) { out << '"' << value << '"'; }
void write_value(std::ostream& out, bool value) { out << (value ? "true" : "false"); }
void write_value(std::ostream& out, const std::vector<std::string>& values) {
  out << '[';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) out << ", ";
    write_value(out, values[i]);
  }
  out << ']';
}
template <class T>
void write_value(std::ostream& out, const T& value) {
  out << value;
}

}  // namespace

Status validate(const ServerOptions& options) {
  Status status;
  ServerOptions copy = options;
  copy.visit_groups([&](const char* name, auto& group, const char*) {
    if (!status.ok()) return;
    status = bpa::validate(group);
    if (!status.ok()) status.message = std::string(name) + "." + status.message;
  });
  if (!status.ok()) return status;
  status = check_choice("network.range", options.network.range,
                        {"environment", "subnet", "localhost", "humble_localhost", "off"});
  if (!status.ok()) return status;
  status = check_choice("network.graph_layout", options.network.graph_layout,
                        {"automatic", "humble", "iron"});
  if (!status.ok()) return status;
  status =
      check_choice("input.color_transport", options.input.color_transport, {"raw", "compressed"});
  if (!status.ok()) return status;
  status = check_choice("input.depth_transport", options.input.depth_transport,
                        {"raw", "compressed", "compressedDepth"});
  if (!status.ok()) return status;
  if (status = check_capture(options.capture); !status.ok()) return status;
  return check_choice("log.level", options.log.level, {"debug", "info", "warning", "error"});
}

Status load_options(const std::string& path, ServerOptions& options) {
  if (!std::filesystem::is_regular_file(path)) {
    return Status(StatusCode::not_found, path + ": there is no such file");
  }
  try {
    return apply_file(path, YAML::LoadFile(path), options);
  } catch (const YAML::Exception& error) {
    return at_line(path, error.mark, "not YAML: " + error.msg);
  }
}

Status set_option(const std::string& assignment, ServerOptions& options) {
  const std::size_t equals = assignment.find('=');
  const std::size_t dot = assignment.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals) {
    return invalid_argument("\"" + assignment + "\" must read group.key=value");
  }
  const std::string group = assignment.substr(0, dot);
  const std::string key = assignment.substr(dot + 1, equals - dot - 1);
  try {
    const YAML::Node node = YAML::Load(assignment.substr(equals + 1));
    const std::string problem = set_field(group, key, node, options);
    if (!problem.empty()) return invalid_argument(problem);
  } catch (const YAML::Exception& error) {
    return invalid_argument("\"" + assignment + "\" is not YAML: " + error.msg);
  }
  return validate(options);
}

std::string to_yaml(const ServerOptions& options, bool with_detector) {
  std::ostringstream out;
  ServerOptions copy = options;
  out << std::setprecision(12);
  copy.visit_groups([&](const char* name, auto& group, const char* about) {
    if (!with_detector && std::string_view(name) == "detector") return;
    out << "\n# " << about << "\n" << name << ":\n";
    group.visit_fields([&](const char* field, auto& value, const FieldRule& rule) {
      out << "  # " << rule.description;
      using Value = std::decay_t<decltype(value)>;
      if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
        out << " " << rule.min << " to " << rule.max << ".";
      }
      if (rule.runtime) out << " Also at run time.";
      out << "\n  " << field << ": ";
      write_value(out, value);
      out << "\n";
    });
  });
  return out.str();
}

}  // namespace bpa::server
