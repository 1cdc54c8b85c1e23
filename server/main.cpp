// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <iostream>

#include <CLI/CLI.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "camera/open_camera.hpp"
#include "core/base/failure.hpp"
#include "core/pipeline/detector_options.hpp"
#include "server/group_servers.hpp"
#include "server/options.hpp"
#include "server/participant_options.hpp"
#include "server/recognition.hpp"
#include "server/ros_arguments.hpp"
#include "server/security/keystore.hpp"
#include "server/server.hpp"
#include "server/supervision.hpp"

// The daemon: command line, log and signals. Exits 0 after SIGINT or SIGTERM, 1 when it cannot
// start (one clear line), 2 on a wrong command line, 3 when a search hangs.

namespace {

using bpa::LogLevel;
using bpa::Status;
using bpa::server::RosArguments;
using bpa::server::ServerOptions;

struct CommandLine {
  std::string config;
  std::vector<std::string> settings;
  bool localhost = false;
  bool print_config = false;
  bool list_devices = false;
  std::string make_keystore;
};

void add_options(CLI::App& program, CommandLine& line) {
  program.add_option("--config", line.config, "file with settings, such as config/server.yaml");
  program.add_flag("--localhost", line.localhost, "talk to this machine only");
  program.add_flag("--print-config", line.print_config, "print all settings and stop");
  program.add_flag("--list-devices", line.list_devices,
                   "print the OpenNI2 sensors, their modes and what is wrong with each, and stop");
  program.add_option(
      "--make-keystore", line.make_keystore,
      "write keys and permissions for DDS Security to a new folder, for the enclaves "
      "/bpa_server, /robot and /viewer, and stop");
  program.add_option("--set", line.settings, "group.key=value, any setting (repeatable)");
  const struct {
    const char* option;
    const char* setting;
    const char* description;
  } shortcuts[] = {
      {"--library", "detection.library", "folder of the model library"},
      {"--detector", "detection.detector", "file with settings of the detector"},
      {"--capture", "capture.source", "openni2, openni2:URI, FILE.oni, bop:FOLDER or bag:PATH"},
      {"--threads", "detection.threads", "0: one per core"},
      {"--seed", "detection.seed", "same frame, library and seed: same answer"},
      {"--namespace", "node.namespace", "ROS namespace, default /bpa"},
      {"--domain", "network.domain", "DDS domain; default ROS_DOMAIN_ID, else 0"},
      {"--keystore", "security.keystore", "folder that --make-keystore or SROS 2 made"},
      {"--enclave", "security.enclave", "whose keys of it to use, default /bpa_server"},
      {"--role", "group.role",
       "single, front or worker: a front's group of workers searches for it"},
      {"--group", "group.name", "of fronts and workers, default bpa"},
      {"--web", "web.listen",
       "[ADDRESS:]PORT of a page for browsers; a port alone: this machine only"},
      {"--log-level", "log.level", "debug, info, warning or error"},
  };
  for (const auto& s : shortcuts) {
    program.add_option_function<std::string>(
        s.option,
        [&line, setting = s.setting](const std::string& value) {
          line.settings.push_back(std::string(setting) + "=" + value);
        },
        s.description);
  }
  // An empty variable of a script must not start a server without security.
  for (const char* option : {"--keystore", "--make-keystore"}) {
    program.get_option(option)->check([](const std::string& folder) {
      return folder.empty() ? std::string("names no folder") : std::string();
    });
  }
}

/// From the weakest to the strongest: defaults, the detector's file, the server's file, single
/// settings, the arguments of ROS. Throws a Failure.
ServerOptions settle(const CommandLine& line, const RosArguments& ros) {
  const auto read = [&](ServerOptions& options) {
    if (!line.config.empty()) or_throw(bpa::server::load_options(line.config, options));
    for (const std::string& setting : line.settings) {
      or_throw(bpa::server::set_option(setting, options));
    }
    if (line.localhost) options.network.range = "localhost";
    or_throw(bpa::server::apply(ros, options));
    or_throw(bpa::server::validate(options));
  };
  ServerOptions options;
  read(options);
  if (options.detection.detector.empty()) return options;
  // Once more, now that it is known which file stands below all the others.
  const bpa::DetectorOptions detector =
      or_throw(bpa::load_detector_options(options.detection.detector));
  options = {};
  options.detector = detector;
  read(options);
  return options;
}

/// What is below log.level does not come here.
bpa::LogHook make_log() {
  auto logger = spdlog::stderr_color_mt("bpa-server");
  logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %^%-7l%$ %v");
  logger->set_level(spdlog::level::debug);
  logger->flush_on(spdlog::level::info);
  return [logger](LogLevel severity, std::string_view text) {
    constexpr spdlog::level::level_enum kLevels[] = {spdlog::level::debug, spdlog::level::info,
                                                     spdlog::level::warn, spdlog::level::err};
    logger->log(kLevels[static_cast<std::size_t>(severity)], "{}", text);
  };
}

/// Until a signal comes. Throws a Failure.
void serve(const ServerOptions& options, const bpa::LogHook& hook, const sigset_t& signals) {
  if (options.group.role == "worker") {
    bpa::server::serve_until_signal(bpa::server::make_worker(options, hook), signals, hook);
    return;
  }
  const std::string& folder = options.detection.library;
  if (folder.empty()) {
    or_throw(bpa::invalid_argument("no model library: give --library DIR (or detection.library)"));
  }
  auto library = or_throw(bpa::server::open_library(options.detection, options.detector, hook));
  if (options.group.role == "front") {
    bpa::server::serve_until_signal(bpa::server::make_front(options, std::move(library), hook),
                                    signals, hook);
    return;
  }
  auto server = or_throw(bpa::server::Server::create(options, std::move(library), hook));
  bpa::log(hook, LogLevel::info, "ready in namespace " + options.node.ros_namespace);
  bpa::server::serve_until_signal(std::move(server), signals, hook);
}

/// For the topics, services and domain of the settings. Throws a Failure.
void make_keystore(const std::string& folder, const ServerOptions& options) {
  const auto enclaves = bpa::server::default_permissions(options);
  const int domain = bpa::server::participant_options(options, {}).discovery->domain_id;
  bpa::server::make_keystore(folder, enclaves, domain);
  std::cout << "for domain " << domain << ":\n";
  for (const auto& permissions : enclaves) {
    std::cout << folder << "/enclaves" << permissions.enclave << '\n';
  }
  std::cout << "keep " << folder << "/private off robots and servers: who has it lets others in\n";
}

int fail(const Status& status, int exit_code) {
  std::cerr << "bpa-server: " << status.message << '\n';
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  // Blocked in all threads, so that only sigwait() sees them.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  const auto ros = bpa::server::take_ros_arguments({argv, argv + argc});
  if (!ros.ok()) return fail(ros.status(), 2);
  CLI::App program("Finds known objects in the RGB-D frames of a DDS domain.", "bpa-server");
  program.footer(
      "ROS 2's own arguments come after --ros-args: -r FROM:=TO, -r __node:=NAME, "
      "-r __ns:=NAMESPACE,\n-p NAME:=VALUE, --params-file FILE, --log-level LEVEL, --enclave "
      "NAME.\n"
      "Exits with 0 after SIGINT or SIGTERM, 1 when it cannot start, 2 on a wrong command line, 3 "
      "when a search hangs.");
  program.set_version_flag("--version", BPA_VERSION);
  CommandLine line;
  add_options(program, line);
  std::vector<std::string> words(ros->own.rbegin(), ros->own.rend() - 1);  // as CLI11 wants them
  try {
    program.parse(words);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  }
  ServerOptions options;
  try {
    options = settle(line, *ros);
  } catch (const std::exception& error) {
    std::cerr << "bpa-server: " << error.what() << '\n';
    return 2;
  }
  if (line.print_config) {
    std::cout << bpa::server::to_yaml(options, true);
    return 0;
  }
  if (line.list_devices) {
    const auto devices = bpa::camera::list_devices();
    if (!devices.ok()) return fail(devices.status(), 1);
    std::cout << *devices;
    return 0;
  }
  const bpa::LogHook hook = make_log();
  try {
    if (!line.make_keystore.empty()) {
      make_keystore(line.make_keystore, options);
      return 0;
    }
    serve(options, hook, signals);
    return 0;
  } catch (const std::exception& error) {
    bpa::log(hook, LogLevel::error, error.what());
    return 1;
  }
}
