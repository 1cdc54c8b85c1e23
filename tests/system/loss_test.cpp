// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/support/process.hpp"

// Requests with frames over a link that loses one packet of twenty each way.

namespace bpa {
namespace {

using std::chrono::milliseconds;

std::vector<std::string> over_a_lossy_link(std::vector<std::string> command) {
  command.insert(command.begin(),
                 {"/usr/bin/env", "LD_PRELOAD=" BPA_BINARY_DIR "/tests/bpa-lossy-sockets.so",
                  "BPA_LOSS=5", BPA_BINARY_DIR "/tests/" + command.front()});
  command.erase(command.begin() + 4);
  return command;
}

TEST(Loss, RequestsWithFramesAreAnswered) {
  const std::string domain = std::to_string(support::test_domain());
  const std::string log = support::scratch_folder() + "/lossy_server.log";
  const std::string said = support::scratch_folder() + "/lossy_client.log";
  const support::Process server(
      over_a_lossy_link({"bpa-stub-server", "--set", "network.domain=" + domain, "--set",
                         "node.namespace=" + support::test_namespace()}),
      log);
  EXPECT_EQ(support::run(over_a_lossy_link(
                             {"bpa-frame-caller", domain, support::test_namespace(), "30", "4000"}),
                         said, milliseconds(120000)),
            0)
      << support::read_text(said) << support::read_text(log);
}

}  // namespace
}  // namespace bpa
