// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/cyclone.hpp"

#include "tests/system/security/secured.hpp"

namespace bpa::test {
namespace {

/// What Cyclone's robot says in five seconds of sending, reading and calling.
std::string robot_on_cyclone() {
  support::keep_cyclone_on_this_machine();
  const std::string log_path = support::scratch_folder() + "/cyclone.log";
  const auto command = support::cyclone_command("cyclone_robot", {support::test_namespace(), "5"});
  EXPECT_EQ(support::run(command, log_path), 0);
  return support::read_text(log_path);
}

using CycloneStranger = Secured;

TEST_F(CycloneStranger, GetsNothing) {
  EXPECT_EQ(robot_on_cyclone(), "sees 0 topics\n");
  expect_unchanged(0, 0);
}

TEST(CycloneRobot, DoesAllOfItWithoutSecurity) {
  support::StubServer server(settings_with(""));
  const std::string said = robot_on_cyclone();
  for (const char* word : {"detections", "interpretations", "answered", "sees"}) {
    EXPECT_NE(said.find(word), std::string::npos) << said << server.log();
  }
  EXPECT_EQ(said.find("sees 0 topics"), std::string::npos) << said;
}

}  // namespace
}  // namespace bpa::test
