// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include "tests/support/process.hpp"

namespace bpa::support {

/// Peers on Eclipse Cyclone DDS that are started from now on look for others on this machine only.
inline void keep_cyclone_on_this_machine() {
  setenv("CYCLONEDDS_URI",
         "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General><Discovery>"
         "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>31"
         "</MaxAutoParticipantIndex><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>"
         "</Domain></CycloneDDS>",
         1);
}

/// A program of the tests folder with this test's domain as its first argument.
inline std::vector<std::string> cyclone_command(const std::string& name,
                                                std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(),
                   {BPA_BINARY_DIR "/tests/" + name, std::to_string(test_domain())});
  return arguments;
}

}  // namespace bpa::support
