// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include <bpa/client.hpp>

#include "idl/wire/participant.hpp"
#include "tests/support/process.hpp"

namespace bpa::support {

/// The stub server as another process, in this test's domain and namespace.
class StubServer {
 public:
  explicit StubServer(const std::vector<std::string>& settings = {}, int delay_ms = 0,
                      const std::vector<std::string>& more_words = {})
      : log_path_(scratch_folder() + "/server.log") {
    command_ = {BPA_BINARY_DIR "/tests/bpa-stub-server",
                "--delay-ms",
                std::to_string(delay_ms),
                "--set",
                "network.domain=" + std::to_string(test_domain()),
                "--set",
                "node.namespace=" + test_namespace(),
                "--set",
                "output.tf=tf",
                "--set",
                "input.tf=tf",
                "--set",
                "input.tf_static=tf_static",
                "--set",
                "output.diagnostics=diagnostics",
                "--set",
                "output.rosout=rosout",
                "--set",
                "node.remaps=['/parameter_events:=parameter_events']"};
    for (const std::string& setting : settings) {
      command_.push_back("--set");
      command_.push_back(setting);
    }
    command_.insert(command_.end(), more_words.begin(), more_words.end());
    start();
  }
  void start() { process_ = std::make_unique<Process>(command_, log_path_); }
  Process& process() { return *process_; }
  /// The command line without the program and its own option.
  std::vector<std::string> words() const { return {command_.begin() + 3, command_.end()}; }
  std::string log() const { return read_text(log_path_); }

 private:
  std::string log_path_;
  std::vector<std::string> command_;
  std::unique_ptr<Process> process_;
};

inline ClientOptions client_options() {
  ClientOptions options;
  options.domain = test_domain();
  options.server_namespace = test_namespace();
  options.range_from_environment = false;
  options.range = DiscoveryRange::localhost;
  options.timeout = std::chrono::milliseconds(10000);
  options.detect_timeout = std::chrono::milliseconds(10000);
  return options;
}

/// A seat in this test's domain, as any ROS 2 process would have.
inline Result<wire::Participant> test_participant(const std::string& name) {
  wire::ParticipantOptions options;
  options.node.node_namespace = test_namespace();
  options.node.name = name;
  wire::Discovery discovery;
  discovery.domain_id = test_domain();
  discovery.range = wire::DiscoveryRange::localhost;
  options.discovery = discovery;
  return wire::Participant::create(std::move(options));
}

}  // namespace bpa::support
