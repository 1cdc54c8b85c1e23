// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/doctor/machine_check.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <net/if.h>

#include "core/base/concat.hpp"

namespace bpa::doctor {
namespace {

namespace fs = std::filesystem;

/// The numbers that a file begins with; none where there is no such file.
std::vector<std::uint64_t> numbers_of(const std::string& path) {
  std::vector<std::uint64_t> numbers;
  std::ifstream file(path);
  for (std::uint64_t number = 0; file >> number;) numbers.push_back(number);
  return numbers;
}

std::vector<fs::path> entries_of(const std::string& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    entries.push_back(entry->path());
  }
  return entries;
}

void check_sockets(const MachineNeeds& needs, Findings& findings) {
  const auto largest = numbers_of(needs.root + "/proc/sys/net/core/rmem_max");
  if (largest.empty() || largest.front() >= needs.image_bytes) return;
  findings.push_back({Severity::warning, "socket buffers are small for images",
                      concat("net.core.rmem_max is ", largest.front(), "; an image has ",
                             needs.image_bytes, " bytes, and what does not fit is lost"),
                      "Run `sysctl -w net.core.rmem_max=8388608 net.core.wmem_max=8388608`."});
}

/// RTPS 2.2, 9.6.1.1: port 7400 + 250 * domain + 11 + 2 * participant is the last of a participant.
void check_ports(const MachineNeeds& needs, Findings& findings) {
  constexpr std::uint64_t kFirst = 7400, kPerDomain = 250;
  constexpr std::uint64_t kPorts = 12 + 2 * 31;  // of the 32 participants that others look for
  constexpr int kMaxDomain = 232;
  if (needs.domain < 0 || needs.domain > kMaxDomain) {
    findings.push_back({Severity::error, "the DDS domain is out of range",
                        concat("it is ", needs.domain, "; it must be between 0 and ", kMaxDomain),
                        "Set ROS_DOMAIN_ID to a number from 0 to 101."});
    return;
  }
  const std::uint64_t first = kFirst + kPerDomain * static_cast<std::uint64_t>(needs.domain);
  const std::uint64_t last = first + kPorts - 1;
  const auto range = numbers_of(needs.root + "/proc/sys/net/ipv4/ip_local_port_range");
  if (range.size() != 2 || last < range[0] || first > range[1]) return;
  findings.push_back({Severity::warning, "other programs may take the DDS domain's ports",
                      concat("domain ", needs.domain, " has ports ", first, " to ", last,
                             "; Linux hands out ", range[0], " to ", range[1]),
                      "Use a domain from 0 to 101 (ROS_DOMAIN_ID)."});
}

void check_interfaces(const MachineNeeds& needs, Findings& findings) {
  constexpr unsigned kMulticast = IFF_UP | IFF_MULTICAST;
  bool seen = false, multicast = false;
  for (const fs::path& interface : entries_of(needs.root + "/sys/class/net")) {
    std::string text;
    std::ifstream(interface / "flags") >> text;
    const auto flags = static_cast<unsigned>(std::strtoul(text.c_str(), nullptr, 16));
    seen = seen || !text.empty();
    multicast = multicast || (flags & kMulticast) == kMulticast;
    if (interface.filename() != "lo" || text.empty() || (flags & IFF_UP) != 0) continue;
    findings.push_back({Severity::error, "the loopback interface is down",
                        "programs on this machine cannot talk to each other",
                        "Run `ip link set lo up`."});
  }
  if (!needs.multicast || !seen || multicast) return;
  findings.push_back({Severity::warning, "no network interface has multicast",
                      "peers are looked for by multicast and will not be found",
                      "Run `ip link set lo multicast on` for peers on this machine, connect a "
                      "network for others, or set ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST or "
                      "ROS_STATIC_PEERS."});
}

}  // namespace

Findings check_machine(const MachineNeeds& needs) {
  Findings findings;
  check_sockets(needs, findings);
  check_ports(needs, findings);
  check_interfaces(needs, findings);
  return findings;
}

}  // namespace bpa::doctor
