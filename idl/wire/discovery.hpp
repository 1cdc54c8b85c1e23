// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/status.hpp"

// How far a participant looks for others.

namespace bpa::wire {

enum class DiscoveryRange {
  subnet,            ///< Multicast on the network, and the static peers.
  localhost,         ///< This machine only, as ROS 2 Iron and later do it; and the static peers.
  off,               ///< Nobody.
  humble_localhost,  ///< This machine only, by the loopback interface alone, as Humble does it.
};

struct Discovery {
  int domain_id = 0;  ///< 0 to 232.
  DiscoveryRange range = DiscoveryRange::subnet;
  std::vector<std::string> static_peers;  ///< Host names or IPv4 addresses.
};

/// From ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS and ROS_LOCALHOST_ONLY
/// (which overrides the others and ignores the peers), as rcl reads them. `invalid_argument` names
/// the variable whose value is not legal.
Result<Discovery> discovery_from_environment();

}  // namespace bpa::wire
