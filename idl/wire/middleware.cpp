// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/middleware.hpp"

#include <cctype>
#include <fstream>
#include <sstream>

#include "idl/wire/private/environment.hpp"

namespace bpa::wire {
namespace {

constexpr const char* kRange[] = {"ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE",
                                  "ROS_STATIC_PEERS"};
constexpr const char* kOthers[] = {"RMW_IMPLEMENTATION",
                                   "RMW_CONNEXT_REQUEST_REPLY_MAPPING",
                                   "FASTRTPS_DEFAULT_PROFILES_FILE",
                                   "FASTDDS_DEFAULT_PROFILES_FILE",
                                   "CYCLONEDDS_URI",
                                   "ROS_DISCOVERY_SERVER"};

std::string value_of(const Environment& environment, const char* name) {
  const auto found = environment.find(name);
  return found == environment.end() ? std::string() : found->second;
}

/// Whether something listens on TCP port 7447, as zenohd does unless told otherwise. UDP says
/// nothing: the 19th participant of DDS domain 0 has the same port.
bool zenoh_router_listens() {
  for (const char* table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    std::ifstream file(table);
    std::string line, number, own, peer, state;  // the first line has titles
    while (std::getline(file, line)) {
      std::istringstream(line) >> number >> own >> peer >> state;
      if (state == "0A" && own.substr(own.find(':') + 1) == "1D17") return true;
    }
  }
  return false;
}

void check_rmw(const std::string& rmw, const std::string& connext_mapping, bool zenoh_router,
               MiddlewareNotes& notes) {
  const std::string is = "RMW_IMPLEMENTATION is " + rmw;
  if (rmw == "rmw_zenoh_cpp") {
    // ros2/rmw_zenoh issue 552: the two name topics in different ways.
    notes.push_back(
        {true, "nodes on Zenoh are not reachable",
         is + ", which is not DDS" +
             (zenoh_router ? "; its router listens on TCP port 7447"
                           : "; no router of it listens on TCP port 7447"),
         "Start these nodes with RMW_IMPLEMENTATION=rmw_fastrtps_cpp or "
         "rmw_cyclonedds_cpp. zenoh-bridge-ros2dds does not translate for rmw_zenoh_cpp: "
         "it joins DDS networks with one another."});
  } else if (rmw.empty() && zenoh_router) {
    notes.push_back(
        {false, "a Zenoh router runs, and nodes of rmw_zenoh_cpp are not reachable",
         "something listens on TCP port 7447, and RMW_IMPLEMENTATION is not set",
         "Start nodes of rmw_zenoh_cpp with RMW_IMPLEMENTATION=rmw_fastrtps_cpp. For DDS nodes of "
         "another network run zenoh-bridge-ros2dds in both; then set RMW_IMPLEMENTATION here, "
         "too."});
  } else if (rmw == "rmw_connextdds" && connext_mapping != "extended") {
    notes.push_back({false, "services may not answer to nodes on Connext",
                     is + ", and RMW_CONNEXT_REQUEST_REPLY_MAPPING is not extended",
                     "Set RMW_CONNEXT_REQUEST_REPLY_MAPPING=extended for these nodes. Topics do "
                     "without."});
  } else if (!rmw.empty() && rmw.rfind("rmw_fastrtps_", 0) != 0 && rmw != "rmw_cyclonedds_cpp" &&
             rmw != "rmw_connextdds") {
    notes.push_back({false, "the middleware of the ROS 2 nodes is not known to speak DDS", is,
                     "Start these nodes with RMW_IMPLEMENTATION=rmw_fastrtps_cpp or "
                     "rmw_cyclonedds_cpp."});
  }
}

void check_range(const Environment& environment, MiddlewareNotes& notes) {
  std::string range = value_of(environment, "ROS_AUTOMATIC_DISCOVERY_RANGE");
  for (char& c : range) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const std::string peers = value_of(environment, "ROS_STATIC_PEERS");
  const bool localhost_only = value_of(environment, "ROS_LOCALHOST_ONLY") == "1";
  if (localhost_only && (!peers.empty() || (!range.empty() && range != "LOCALHOST"))) {
    notes.push_back({true, "peers on other machines are not reachable",
                     "ROS_LOCALHOST_ONLY is 1, which overrides " +
                         (peers.empty() ? "ROS_AUTOMATIC_DISCOVERY_RANGE=" + range
                                        : "ROS_STATIC_PEERS=" + peers),
                     "Unset ROS_LOCALHOST_ONLY, here and for the nodes."});
  } else if (!localhost_only && range == "OFF") {
    notes.push_back({true, "no peer is reachable", "ROS_AUTOMATIC_DISCOVERY_RANGE is OFF",
                     "Set ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST for this machine, or SUBNET."});
  }
  if ((localhost_only || range == "LOCALHOST") &&
      !value_of(environment, "CYCLONEDDS_URI").empty()) {
    notes.push_back({false, "nodes on Cyclone DDS may not be reachable",
                     "we look on this machine alone, and CYCLONEDDS_URI, which only they read, may "
                     "tie them to the interface lo",
                     "If it names lo, start bpa-server with --set network.range=humble_localhost, "
                     "or take the interface out of CYCLONEDDS_URI."});
  }
}

}  // namespace

MiddlewareNotes check_middleware(const Environment& environment, int fastdds_major,
                                 bool zenoh_router) {
  MiddlewareNotes notes;
  const std::string rmw = value_of(environment, "RMW_IMPLEMENTATION");
  check_rmw(rmw, value_of(environment, "RMW_CONNEXT_REQUEST_REPLY_MAPPING"), zenoh_router, notes);
  const bool three = fastdds_major >= 3;
  const char* read = three ? "FASTDDS_DEFAULT_PROFILES_FILE" : "FASTRTPS_DEFAULT_PROFILES_FILE";
  const char* other = three ? "FASTRTPS_DEFAULT_PROFILES_FILE" : "FASTDDS_DEFAULT_PROFILES_FILE";
  if (const std::string file = value_of(environment, other);
      !file.empty() && value_of(environment, read).empty()) {
    const std::string ours = three ? "3" : "2";
    notes.push_back({false, "the Fast DDS profiles are not read",
                     std::string(other) + " is " + file + "; Fast DDS " + ours + " reads " + read,
                     std::string("Set ") + read + " to a file for Fast DDS " + ours +
                         "; the generations name some elements differently (heartbeatPeriod in 2, "
                         "heartbeat_period in 3)."});
  }
  if (const std::string server = value_of(environment, "ROS_DISCOVERY_SERVER");
      !server.empty() && (rmw == "rmw_cyclonedds_cpp" || rmw == "rmw_connextdds")) {
    notes.push_back({true, "nodes of other vendors than Fast DDS are not reachable",
                     "ROS_DISCOVERY_SERVER is " + server +
                         ", which Fast DDS alone can use, and "
                         "RMW_IMPLEMENTATION is " +
                         rmw,
                     "Unset ROS_DISCOVERY_SERVER for bpa, or start the nodes with "
                     "RMW_IMPLEMENTATION=rmw_fastrtps_cpp."});
  }
  check_range(environment, notes);
  return notes;
}

MiddlewareNotes check_middleware(bool range_from_environment) {
  Environment environment;
  for (const char* name : kOthers) environment[name] = detail::variable(name);
  for (const char* name : kRange) {
    if (range_from_environment) environment[name] = detail::variable(name);
  }
  return check_middleware(environment, BPA_FASTDDS_MAJOR, zenoh_router_listens());
}

std::string line_of(const MiddlewareNote& note) {
  return note.what + ": " + note.why + ". " + note.remedy;
}

}  // namespace bpa::wire
