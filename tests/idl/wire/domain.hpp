// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <unistd.h>

#include "idl/wire/participant.hpp"

namespace bpa::wire {

/// Of this machine only, and on a domain of this process's own unless told, so that test programs
/// that run side by side do not hear each other.
inline Discovery test_discovery(int domain_id = 1 + getpid() % 100) {
  Discovery discovery;
  discovery.domain_id = domain_id;
  discovery.range = DiscoveryRange::localhost;
  return discovery;
}

inline Result<Participant> test_participant(const std::string& name, LogHook log = {},
                                            int domain_id = 1 + getpid() % 100) {
  ParticipantOptions options;
  options.node.name = name;
  options.discovery = test_discovery(domain_id);
  options.log = std::move(log);
  return Participant::create(std::move(options));
}

}  // namespace bpa::wire
