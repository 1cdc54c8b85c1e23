// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/discovery.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <string_view>

namespace bpa::wire {
namespace {

constexpr int kMaxDomainId = 232;  // the ports of a higher one are beyond 65535

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

Result<int> domain_id(const std::string& text) {
  int id = 0;
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, id);
  if (error != std::errc() || stopped != end || id < 0 || id > kMaxDomainId) {
    return invalid_argument("ROS_DOMAIN_ID is '" + text + "'; it must be a number from 0 to 232");
  }
  return id;
}

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(';'), text.size());
    if (end != 0) parts.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

}  // namespace

Result<Discovery> discovery_from_environment() {
  Discovery result;
  const std::string domain = variable("ROS_DOMAIN_ID");
  if (!domain.empty()) {
    Result<int> id = domain_id(domain);
    if (!id.ok()) return id.status();
    result.domain_id = *id;
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
  result.static_peers = split(variable("ROS_STATIC_PEERS"));
  return result;
}

}  // namespace bpa::wire
