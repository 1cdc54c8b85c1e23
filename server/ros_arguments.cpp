// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/ros_arguments.hpp"

#include <yaml-cpp/yaml.h>

#include "core/base/failure.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/yaml_text.hpp"
#include "idl/wire/names.hpp"
#include "server/parameters.hpp"

namespace bpa::server {
namespace {

bool is_log_switch(const std::string& word) {
  for (const std::string what : {"stdout", "rosout", "external-lib"}) {
    if (word == "--enable-" + what + "-logs" || word == "--disable-" + what + "-logs") return true;
  }
  return false;
}

/// "name:=value" taken apart; both empty when it is not of that form.
wire::Remap split(const std::string& text) {
  const Result<wire::Remap> parts = wire::parse_remap(text);
  return parts.ok() ? *parts : wire::Remap();
}

Status set_parameter_text(const std::string& name, const std::string& value,
                          ServerOptions& options) {
  return set_option((name == kUseSimTime ? "node." : "") + name + "=" + value, options);
}

std::string text_of(const YAML::Node& node) {
  YAML::Emitter text;
  text << YAML::Flow << node;
  return text.c_str();
}

/// Sets the leaves of a map: nested keys are joined by dots. Throws a Failure, as set_file() does.
void set_tree(const std::string& path, const std::string& prefix, const YAML::Node& tree,
              ServerOptions& options) {
  for (const auto& entry : tree) {
    const std::string name = prefix + entry.first.as<std::string>();
    if (entry.second.IsMap()) {
      set_tree(path, name + ".", entry.second, options);
    } else {
      or_throw(set_parameter_text(name, text_of(entry.second), options),
               path + ":" + std::to_string(entry.first.Mark().line + 1));
    }
  }
}

/// Sets what a file says of this node. `scope` is the namespace that `tree` stands for.
void set_file(const std::string& path, const std::string& scope, const YAML::Node& tree,
              ServerOptions& options) {
  const wire::NodeName node{options.node.ros_namespace, options.node.name};
  for (const auto& entry : tree) {
    const auto key = entry.first.as<std::string>();
    if (!entry.second.IsMap()) continue;
    const bool any = key == "/**" || key == "**" || key == "/*" || key == "*";
    const bool ours = any || key == node.full() || scope + "/" + key == node.full() ||
                      (scope.empty() && key == node.name);
    const YAML::Node parameters = entry.second["ros__parameters"];
    if (parameters && ours) {
      set_tree(path, "", parameters, options);
    } else if (!parameters) {  // a namespace
      const std::string below = key[0] == '/' ? key : scope + "/" + key;
      set_file(path, any ? node.node_namespace : below, entry.second, options);
    }
  }
}

Status load_file(const std::string& path, ServerOptions& options) {
  if (!io::is_file(path)) {
    return Status(StatusCode::not_found, path + ": there is no such file");
  }
  const Result<std::string> text = io::read_file(path);
  if (!text.ok()) return text.status();
  try {
    set_file(path, "", io::parse_yaml(*text), options);
    return {};
  } catch (const Failure& failure) {
    return failure.status();
  } catch (const YAML::Exception& error) {
    return invalid_argument(path + ":" + std::to_string(error.mark.line + 1) +
                            ": not a parameter file: " + error.msg);
  }
}

/// Names first: files and parameters are looked up by them. NODE:from:=to is for one node alone.
void set_names(const std::vector<std::string>& remaps, ServerOptions& options) {
  std::vector<wire::Remap> others;
  for (const std::string& text : remaps) {
    wire::Remap remap = split(text);
    if (remap.from == "__node" || remap.from == "__name") {
      options.node.name = remap.to;
    } else if (remap.from == "__ns") {
      options.node.ros_namespace = remap.to;
    } else {
      others.push_back(std::move(remap));
    }
  }
  for (wire::Remap& remap : others) {
    if (const std::size_t colon = remap.from.find(':'); colon != std::string::npos) {
      if (remap.from.substr(0, colon) != options.node.name) continue;
      remap.from.erase(0, colon + 1);
    }
    options.node.remaps.push_back(remap.from + ":=" + remap.to);
  }
}

}  // namespace

Result<RosArguments> take_ros_arguments(const std::vector<std::string>& command_line) {
  RosArguments taken;
  bool for_ros = false;
  for (std::size_t i = 0; i < command_line.size(); ++i) {
    const std::string& word = command_line[i];
    if (word == "--ros-args" || (for_ros && word == "--")) {
      for_ros = word == "--ros-args";
      continue;
    }
    if (!for_ros) {
      taken.own.push_back(word);
      continue;
    }
    // ROS 2's loggers are configured by it; log.level and output.rosout decide here.
    const bool ignored = word == "--log-config-file";
    std::vector<std::string>* list = word == "-r" || word == "--remap"   ? &taken.remaps
                                     : word == "-p" || word == "--param" ? &taken.parameters
                                     : word == "--params-file"           ? &taken.files
                                                                         : nullptr;
    if (is_log_switch(word)) continue;  // legal; log.level and output.rosout decide here
    const bool is_enclave = word == "-e" || word == "--enclave";
    if (list == nullptr && word != "--log-level" && !is_enclave && !ignored) {
      return invalid_argument("'" + word + "' after --ros-args is not known; end it with --");
    }
    if (i + 1 == command_line.size()) return invalid_argument(word + " needs a value");
    const std::string& value = command_line[++i];
    if (ignored) continue;
    if (is_enclave) {
      taken.enclave = value;
      continue;
    }
    if (list == nullptr) {
      const wire::Remap level = split(value);  // LOGGER:=LEVEL or LEVEL
      taken.log_level = level.to.empty() ? value : level.to;
      continue;
    }
    if (list != &taken.files && split(value).from.empty()) {
      return invalid_argument(word + " " + value + " must read name:=value");
    }
    list->push_back(value);
  }
  return taken;
}

Status apply(const RosArguments& arguments, ServerOptions& options) {
  set_names(arguments.remaps, options);
  Status status;
  for (const std::string& path : arguments.files) {
    if (status.ok()) status = load_file(path, options);
  }
  for (const std::string& text : arguments.parameters) {
    const wire::Remap parameter = split(text);
    if (status.ok()) status = set_parameter_text(parameter.from, parameter.to, options);
  }
  if (status.ok() && !arguments.enclave.empty()) options.security.enclave = arguments.enclave;
  if (!status.ok() || arguments.log_level.empty()) return status;
  std::string level = arguments.log_level;
  for (char& c : level) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (level == "warn") level = "warning";
  if (level == "fatal") level = "error";
  return set_option("log.level=" + level, options);
}

}  // namespace bpa::server
