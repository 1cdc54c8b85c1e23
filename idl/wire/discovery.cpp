// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <charconv>
#include <sstream>

#include "idl/wire/participant.hpp"
#include "idl/wire/private/environment.hpp"

namespace bpa::wire {
namespace {

constexpr int kMaxDomainId = 232;  // the ports of a higher one are beyond 65535

using detail::variable;

}  // namespace

Result<Discovery> discovery_from_environment() {
  Discovery result;
  const std::string domain = variable("ROS_DOMAIN_ID");
  if (!domain.empty()) {
    int& id = result.domain_id;
    const char* end = domain.data() + domain.size();
    const auto [stopped, error] = std::from_chars(domain.data(), end, id);
    if (error != std::errc() || stopped != end || id < 0 || id > kMaxDomainId) {
      return invalid_argument("ROS_DOMAIN_ID is '" + domain +
                              "'; it must be a number from 0 to 232");
    }
  }

  const std::string localhost_only = variable("ROS_LOCALHOST_ONLY");
  if (localhost_only == "1") {
    result.range = DiscoveryRange::localhost;
    return result;
  }
  if (!localhost_only.empty() && localhost_only != "0") {
    return invalid_argument("ROS_LOCALHOST_ONLY is '" + localhost_only + "'; it must be 0 or 1");
  }

  std::string range = variable("ROS_AUTOMATIC_DISCOVERY_RANGE");
  std::transform(range.begin(), range.end(), range.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  if (range == "LOCALHOST") {
    result.range = DiscoveryRange::localhost;
  } else if (range == "OFF") {
    result.range = DiscoveryRange::off;
  } else if (!range.empty() && range != "SUBNET" && range != "SYSTEM_DEFAULT") {
    return invalid_argument("ROS_AUTOMATIC_DISCOVERY_RANGE is '" + range +
                            "'; it must be SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT");
  }
  std::istringstream peers(variable("ROS_STATIC_PEERS"));
  for (std::string peer; std::getline(peers, peer, ';');) {
    if (!peer.empty()) result.static_peers.push_back(peer);
  }
  return result;
}

}  // namespace bpa::wire
