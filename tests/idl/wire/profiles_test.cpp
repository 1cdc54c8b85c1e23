// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Profiles stay with the process, so these tests have one of their own.
#include <chrono>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/idl/wire/domain.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::wire {
namespace {

using std::chrono::seconds;

Result<Participant> with_profiles(const std::string& path, LogHook log = {}) {
  ParticipantOptions options;
  options.discovery = test_discovery();
  options.profiles = path;
  options.log = std::move(log);
  return Participant::create(std::move(options));
}

TEST(Profiles, AFileThatIsNoneIsRefusedByName) {
  const test::TemporaryFolder folder;
  EXPECT_NE(with_profiles(folder / "none.xml").status().message.find("none.xml"),
            std::string::npos);
  std::ofstream(folder / "bad.xml") << "<dds><profiles><participant";
  EXPECT_EQ(with_profiles(folder / "bad.xml").status().code, StatusCode::invalid_argument);
}

TEST(Profiles, TheInstalledFileIsWhatThereIsWithoutOne) {
  const auto plain = test_participant("plain");
  ASSERT_TRUE(plain.ok());
  auto publisher = Publisher<std_msgs::String>::create(*plain, "text");
  std::string said;
  const auto profiled =
      with_profiles(BPA_BINARY_DIR "/config/dds_profiles.xml", [&](LogLevel level, auto text) {
        if (level >= LogLevel::warning) said += std::string(text) + "\n";
      });
  ASSERT_TRUE(profiled.ok()) << profiled.status().message;
  const auto subscriber = Subscriber<std_msgs::String>::create(
      *profiled, "text", {}, [](std_msgs::String&&, const SampleMeta&) {});
  EXPECT_TRUE(publisher->wait_for_matched(seconds(10)));
  EXPECT_TRUE(subscriber->wait_for_matched(seconds(10)));
  EXPECT_EQ(said, "");  // no shared-memory transport, and nothing of it unknown to Fast DDS
}

}  // namespace
}  // namespace bpa::wire
