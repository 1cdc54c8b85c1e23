// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/ros_clock.hpp"

#include <chrono>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "idl/wire/publisher.hpp"
#include "idl/wire/time.hpp"
#include "tests/support/process.hpp"

namespace bpa::server {
namespace {

using std::chrono::milliseconds;
using wire::rosgraph_msgs::Clock;

class RosClockTest : public testing::Test {
 protected:
  static wire::Participant seat(const std::string& name) {
    wire::ParticipantOptions options;
    options.node = {support::test_namespace(), name};
    options.discovery = wire::Discovery{.domain_id = support::test_domain(),
                                        .range = wire::DiscoveryRange::localhost,
                                        .static_peers = {}};
    return wire::Participant::create(std::move(options)).value();
  }
  /// Publishes a time until the clock has it.
  bool tick(std::int64_t stamp_ns) {
    for (int i = 0; i < 2000 && clock.stamp_ns() != stamp_ns; ++i) {
      EXPECT_TRUE(publisher->publish(Clock{wire::builtin_interfaces::from_ns(stamp_ns)}).ok());
      std::this_thread::sleep_for(milliseconds(5));
    }
    return clock.stamp_ns() == stamp_ns;
  }

  const wire::Participant simulator = seat("simulator"), robot = seat("robot");
  Result<wire::Publisher<Clock>> publisher =
      wire::Publisher<Clock>::create(simulator, "/clock", {});
  RosClock clock;
};

TEST_F(RosClockTest, IsThisMachinesTimeUntilItIsSimulated) {
  EXPECT_TRUE(clock.is_real());
  const std::int64_t before = unix_time_ns();
  const std::int64_t stamp = clock.stamp_ns();
  EXPECT_GE(stamp, before);
  EXPECT_LE(stamp, unix_time_ns());
  const auto now = clock.now();
  ASSERT_TRUE(clock.simulate(robot, true).ok());
  EXPECT_FALSE(clock.is_real());
  EXPECT_EQ(clock.stamp_ns(), 0);  // as in rclcpp
  const auto still = clock.now();
  EXPECT_GE(still, now);
  EXPECT_EQ(clock.now(), still);
  EXPECT_EQ(clock.report().level, SourceReport::kOk);
}

TEST_F(RosClockTest, GrowsByWhatPassesOnTheTopicAndNeverGoesBack) {
  ASSERT_TRUE(clock.simulate(robot, true).ok());
  const auto start = clock.now();
  ASSERT_TRUE(tick(1'000'000'000'000));  // where it begins says nothing of what passed
  EXPECT_EQ(clock.now() - start, milliseconds(0));
  ASSERT_TRUE(tick(1'002'500'000'000));
  EXPECT_EQ(clock.now() - start, milliseconds(2500));
  ASSERT_TRUE(tick(1'000'000'000'000));  // the recording is played again
  EXPECT_EQ(clock.now() - start, milliseconds(2500));
  ASSERT_TRUE(tick(1'001'000'000'000));
  EXPECT_EQ(clock.now() - start, milliseconds(3500));
  ASSERT_TRUE(clock.simulate(robot, false).ok());
  EXPECT_GE(clock.now() - start, milliseconds(3500));
  EXPECT_GT(clock.stamp_ns(), 1'600'000'000'000'000'000);
}

}  // namespace
}  // namespace bpa::server
