// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/middleware.hpp"

#include <gtest/gtest.h>

namespace bpa::wire {
namespace {

/// A word that the remedy has if the remedy fits; empty: nothing may be said.
struct Case {
  Environment environment;
  int fastdds_major;
  bool zenoh_router;
  const char* remedy;
  bool unreachable = false;
};

TEST(Middleware, EachTroubleHasTheRemedyThatFits) {
  const std::string rmw = "RMW_IMPLEMENTATION", two = "FASTRTPS_DEFAULT_PROFILES_FILE",
                    three = "FASTDDS_DEFAULT_PROFILES_FILE", server = "ROS_DISCOVERY_SERVER",
                    only = "ROS_LOCALHOST_ONLY", range = "ROS_AUTOMATIC_DISCOVERY_RANGE",
                    peers = "ROS_STATIC_PEERS", uri = "CYCLONEDDS_URI";
  const Case cases[] = {
      {{}, 2, false, ""},
      {{{rmw, "rmw_fastrtps_cpp"}}, 2, true, ""},
      {{{rmw, "rmw_fastrtps_dynamic_cpp"}}, 3, false, ""},
      {{{rmw, "rmw_cyclonedds_cpp"}, {uri, "file:///c.xml"}}, 2, false, ""},
      {{{rmw, "rmw_zenoh_cpp"}}, 2, false, "=rmw_fastrtps_cpp", true},
      {{{rmw, "rmw_zenoh_cpp"}}, 3, true, "zenoh-bridge-ros2dds does not translate", true},
      {{}, 2, true, "run zenoh-bridge-ros2dds"},
      {{{rmw, "rmw_connextdds"}}, 2, false, "RMW_CONNEXT_REQUEST_REPLY_MAPPING=extended"},
      {{{rmw, "rmw_connextdds"}, {"RMW_CONNEXT_REQUEST_REPLY_MAPPING", "extended"}}, 2, false, ""},
      {{{rmw, "rmw_email_cpp"}}, 2, false, "=rmw_fastrtps_cpp"},
      {{{two, "a.xml"}}, 2, false, ""},
      {{{three, "a.xml"}}, 3, false, ""},
      {{{two, "a.xml"}, {three, "b.xml"}}, 2, false, ""},
      {{{three, "a.xml"}}, 2, false, "Set FASTRTPS_DEFAULT_PROFILES_FILE"},
      {{{two, "a.xml"}}, 3, false, "Set FASTDDS_DEFAULT_PROFILES_FILE"},
      {{{server, "h:11811"}}, 2, false, ""},
      {{{server, "h:11811"}, {rmw, "rmw_fastrtps_cpp"}}, 2, false, ""},
      {{{server, "h:11811"}, {rmw, "rmw_cyclonedds_cpp"}}, 2, false, "Unset ROS_DISC", true},
      {{{only, "1"}}, 2, false, ""},
      {{{only, "1"}, {range, "localhost"}}, 2, false, ""},
      {{{only, "1"}, {peers, "10.0.0.1"}}, 2, false, "Unset ROS_LOCALHOST_ONLY", true},
      {{{only, "1"}, {range, "SUBNET"}}, 2, false, "Unset ROS_LOCALHOST_ONLY", true},
      {{{range, "off"}}, 2, false, "=LOCALHOST", true},
      {{{range, "LOCALHOST"}, {uri, "x"}}, 2, false, "humble_localhost"},
  };
  for (const Case& one : cases) {
    std::string given = one.zenoh_router ? "router " : "";
    for (const auto& [name, value] : one.environment) given += name + "=" + value + " ";
    const MiddlewareNotes notes =
        check_middleware(one.environment, one.fastdds_major, one.zenoh_router);
    const bool silent = std::string(one.remedy).empty();
    ASSERT_EQ(notes.size(), silent ? 0U : 1U) << given;
    if (silent) continue;
    EXPECT_NE(notes[0].remedy.find(one.remedy), std::string::npos) << line_of(notes[0]);
    EXPECT_EQ(notes[0].unreachable, one.unreachable) << given;
  }
}

}  // namespace
}  // namespace bpa::wire
