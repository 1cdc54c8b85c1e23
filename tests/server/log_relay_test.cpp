// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/log_relay.hpp"

#include <condition_variable>
#include <mutex>
#include <vector>

#include <gtest/gtest.h>

#include "idl/wire/subscriber.hpp"
#include "tests/support/process.hpp"

namespace bpa::server {
namespace {

using wire::rcl_interfaces::Log;

wire::Participant seat(const std::string& name) {
  wire::ParticipantOptions options;
  options.node = {support::test_namespace(), name};
  wire::Discovery discovery;
  discovery.domain_id = support::test_domain();
  discovery.range = wire::DiscoveryRange::localhost;
  options.discovery = discovery;
  return wire::Participant::create(std::move(options)).value();
}

TEST(LogRelay, LevelsAreFilteredAndChangeAtRunTime) {
  std::vector<std::string> said;
  LogRelay relay([&](LogLevel, std::string_view text) { said.emplace_back(text); }, LogLevel::info);
  const LogHook hook = relay.hook();
  log(hook, LogLevel::debug, "a");
  log(hook, LogLevel::info, "b");
  relay.set_level(LogLevel::error);
  log(hook, LogLevel::warning, "c");
  relay.set_level(LogLevel::debug);
  log(hook, LogLevel::debug, "d");
  EXPECT_EQ(said, (std::vector<std::string>{"b", "d"}));
}

TEST(LogRelay, RosoutGetsWhatWasSaidAlsoBeforeAnybodyListened) {
  const wire::Participant speaker = seat("speaker");
  LogHook hook;
  int line = 0;
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<Log> heard;
  {
    LogRelay relay({}, LogLevel::info);
    hook = relay.hook();
    log(hook, LogLevel::warning, "before there was a participant");
    relay.connect(speaker, "rosout");
    log(hook, LogLevel::error, "then");
    line = __LINE__ - 1;
    wire::SubscriberOptions options;
    options.qos = wire::qos::rosout();
    const wire::Participant listener = seat("listener");
    const auto subscriber = wire::Subscriber<Log>::create(
        listener, "rosout", options, [&](Log&& message, const wire::SampleMeta&) {
          const std::lock_guard<std::mutex> lock(mutex);
          heard.push_back(std::move(message));
          changed.notify_all();
        });
    ASSERT_TRUE(subscriber.ok());
    std::unique_lock<std::mutex> lock(mutex);
    ASSERT_TRUE(
        changed.wait_for(lock, std::chrono::seconds(10), [&] { return heard.size() == 2; }));
  }
  EXPECT_EQ(heard[0].msg, "before there was a participant");
  EXPECT_EQ(heard[0].level, Log::kWarn);
  EXPECT_EQ(heard[0].name, support::test_namespace().substr(1) + ".speaker");
  EXPECT_GT(heard[0].stamp.sec, 1'600'000'000);
  EXPECT_EQ(heard[1].msg, "then");
  EXPECT_EQ(heard[1].level, Log::kError);
  EXPECT_EQ(heard[1].file, "tests/server/log_relay_test.cpp");
  EXPECT_EQ(heard[1].function, "TestBody");
  EXPECT_EQ(heard[1].line, static_cast<std::uint32_t>(line));
  log(hook, LogLevel::error, "after it has gone");  // goes nowhere, harms nobody
}

}  // namespace
}  // namespace bpa::server
