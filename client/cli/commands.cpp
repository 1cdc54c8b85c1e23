// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/commands.hpp"

#include <csignal>
#include <iostream>
#include <thread>

namespace bpa::cli {
namespace {

volatile std::sig_atomic_t interrupt_count = 0;

}  // namespace

void add_common(CLI::App& program, Common& common) {
  program
      .add_option("--domain", common.options.domain, "DDS domain; default ROS_DOMAIN_ID, else 0")
      ->check(CLI::Range(0, 232));
  program.add_option("--namespace", common.options.server_namespace, "ROS namespace of the server")
      ->capture_default_str();
  program.add_flag("--localhost", common.localhost, "look for servers on this machine only");
  program.add_option("--peer", common.options.peers,
                     "another host to look for servers on (repeatable)");
  program
      .add_option("--keystore", common.options.keystore,
                  "DDS Security: folder that bpa-server --make-keystore or SROS 2 made")
      ->check([](const std::string& folder) {
        return folder.empty() ? std::string("names no folder") : std::string();
      });
  program.add_option("--enclave", common.options.enclave, "whose keys of the keystore to use")
      ->capture_default_str();
  program.add_option("--timeout", common.timeout_s, "seconds to wait for the server")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

void catch_interrupts() {
  std::signal(SIGINT, [](int) { interrupt_count = 1; });
  std::signal(SIGTERM, [](int) { interrupt_count = 1; });
}

bool interrupted() { return interrupt_count > 0; }

void wait_until(const std::function<bool()>& done) {
  while (!interrupted() && !done()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

ClientOptions Common::client_options() const {
  ClientOptions all = options;
  all.timeout = std::chrono::milliseconds(static_cast<long>(1000 * timeout_s));
  if (localhost) {
    all.range_from_environment = false;
    all.range = DiscoveryRange::localhost;
  }
  all.log = [](const std::string& text) { std::cerr << "bpa-client: " << text << '\n'; };
  return all;
}

Client Common::connect() const { return or_throw(Client::connect(client_options())); }

}  // namespace bpa::cli
