// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Settings files, ROS parameter files and command lines, names and remaps.
#include "idl/wire/names.hpp"
#include "server/options.hpp"
#include "server/ros_arguments.hpp"
#include "tests/fuzz/target.hpp"

namespace bpa::fuzz {
namespace {

using server::ServerOptions;

std::vector<std::string> lines_of(std::string_view bytes) {
  std::vector<std::string> lines;
  while (!bytes.empty()) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    lines.emplace_back(bytes.substr(0, end));
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
  }
  return lines;
}

void run_settings(std::string_view bytes) {
  ServerOptions options;
  if (!server::load_options(file_of(bytes, "server.yaml"), options).ok()) return;
  require(server::validate(options).ok(), "settings that were read are legal");
}

std::vector<std::string> settings_seeds() {
  constexpr std::size_t kSome = 1500;  // each setting is checked with all others
  return {server::to_yaml(ServerOptions(), false).substr(0, kSome),
          "detector:\n  surface: {max_range_m: 2}\nmax_width: 320\n",
          "node:\n  remaps: [a:=b, \"c:=d\"]\nlog:\n  level: debug\n"};
}

void run_parameter_file(std::string_view bytes) {
  server::RosArguments arguments;
  arguments.files = {file_of(bytes, "parameters.yaml")};
  ServerOptions options;
  (void)server::apply(arguments, options);
}

std::vector<std::string> parameter_file_seeds() {
  return {"/**:\n  ros__parameters:\n    use_sim_time: true\n    detection.top_k: 3\n",
          "/a:\n  bpa:\n    ros__parameters: {detection: {top_k: 3}}\n"
          "bpa:\n  ros__parameters:\n    log: {level: debug}\n"};
}

/// One word of a command line in each line.
void run_command_line(std::string_view bytes) {
  std::vector<std::string> words = lines_of(bytes);
  auto arguments = server::take_ros_arguments(words);
  if (!arguments.ok()) return;
  arguments->files.clear();  // the target parameter_file reads them
  ServerOptions options;
  (void)server::apply(*arguments, options);
}

std::vector<std::string> command_line_seeds() {
  return {
      "bpa-server\n--ros-args\n-r\n__node:=a\n-r\n__ns:=/b\n-r\nbpa:x:=y\n-p\n"
      "detection.top_k:=3\n--log-level\nbpa:=WARN\n--\n--library\nx",
      "--ros-args\n--param\nlog.level:=debug\n--disable-stdout-logs\n--params-file\np.yaml",
      "--ros-args\n-p\nnode.remaps:=[a:=b]\n--log-config-file\nx\n--enclave\n/"};
}

/// A name, the node's namespace and its name, and remaps, each in a line.
void run_names(std::string_view bytes) {
  const std::vector<std::string> lines = lines_of(bytes);
  if (lines.size() < 3) return;
  std::vector<wire::Remap> remaps;
  for (std::size_t i = 3; i < lines.size(); ++i) {
    if (const auto remap = wire::parse_remap(lines[i]); remap.ok()) remaps.push_back(*remap);
  }
  const auto name = wire::resolve_name(lines[0], {lines[1], lines[2]}, remaps);
  if (!name.ok()) return;
  require(wire::validate_full_name(*name).ok(), "a resolved name is legal");
  (void)wire::dds_topic_name(*name);
}

std::vector<std::string> names_seeds() {
  return {"~/detections\n/a/b\nbpa\ndetections:=other\n/x:=/y\n", "image\n/\nbpa\nimage:=~/z"};
}

}  // namespace

std::vector<Target> settings_targets() {
  const char* const ros = "server/ros_arguments.cpp";
  return {{"settings", "core/io/options_yaml.cpp", run_settings, settings_seeds},
          {"parameter_file", ros, run_parameter_file, parameter_file_seeds, 4096},
          {"command_line", ros, run_command_line, command_line_seeds, 2048},
          {"names", "idl/wire/names.cpp", run_names, names_seeds, 1024}};
}

}  // namespace bpa::fuzz
