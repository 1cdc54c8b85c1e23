// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/diagnostics.hpp"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "idl/wire/time.hpp"

namespace bpa::server {
namespace {

using std::chrono::milliseconds;
using wire::diagnostic_msgs::DiagnosticStatus;

TEST(RateMeter, CountsOverTheLastTenSeconds) {
  RateMeter meter;
  const RateMeter::TimePoint start{};
  EXPECT_EQ(meter.rates().frames_received, 0);
  Counts counts;
  for (int second = 0; second <= 40; ++second) {
    meter.add(start + milliseconds(1000 * second), counts);
    counts.frames_received += second < 20 ? 30 : 10;  // the camera slows down after 20 s
    counts.frames_processed += 5;
    counts.frames_failed += 1;
    counts.frames_rejected += 2;
    counts.losses += {1, 2, 3, 4};
  }
  EXPECT_DOUBLE_EQ(meter.rates().frames_received, 10);
  EXPECT_DOUBLE_EQ(meter.rates().frames_processed, 5);
  EXPECT_DOUBLE_EQ(meter.rates().frames_bad, 3);
  EXPECT_DOUBLE_EQ(meter.rates().requests_served, 0);
  EXPECT_DOUBLE_EQ(meter.rates().requests_lost, 9);  // those refused count as refused
}

TEST(RateMeter, KeepsTheLastReadingBeforeTheWindow) {
  RateMeter meter;
  Counts counts;
  meter.add(RateMeter::TimePoint(), counts);
  counts.frames_received = 100;
  meter.add(RateMeter::TimePoint(milliseconds(50'000)), counts);  // nobody read it for long
  EXPECT_DOUBLE_EQ(meter.rates().frames_received, 2);
}

class Diagnostics : public testing::Test {
 protected:
  Diagnostics() {
    health.node = "/bpa/server";
    health.status.model_count = 3;
    health.status.version = "9.1";
    health.status.state = wire::bpa_msgs::GetStatus_Response::kRunning;
  }
  /// The status of a name, which must be there once.
  DiagnosticStatus status(const std::string& what) const {
    const auto message = diagnostics_message(health, 5'000'000'000);
    EXPECT_EQ(to_ns(message.header.stamp), 5'000'000'000);
    const std::string name = std::string("/bpa/server: ").append(what);
    DiagnosticStatus found;
    int count = 0;
    for (const DiagnosticStatus& one : message.status) {
      if (one.name != name) continue;
      found = one;
      ++count;
    }
    EXPECT_EQ(count, 1) << what;
    return found;
  }
  std::map<std::string, std::string> values(const std::string& what) const {
    std::map<std::string, std::string> map;
    for (const auto& pair : status(what).values) map[pair.key] = pair.value;
    return map;
  }

  Health health;
};

TEST_F(Diagnostics, RatesTimesAndMemory) {
  health.rates.frames_received = 29.97;
  health.status.stage_timings = {{"cloud", 12.5}};
  health.status.memory_bytes = 123'400'000;
  health.fusion = {{"frames combined anew", "2"}};
  health.effort = {{"rounds", 4}, {"full scores", 87}};
  EXPECT_EQ(status("detection").level, DiagnosticStatus::kOk);
  EXPECT_EQ(status("detection").hardware_id, "bpa-server 9.1");
  EXPECT_EQ(values("detection").at("frames received per s"), "29.97");
  EXPECT_EQ(values("detection").at("median ms of cloud"), "12.500");
  EXPECT_EQ(values("detection").at("memory MB"), "123.4");
  EXPECT_EQ(values("detection").at("frames combined anew"), "2");
  EXPECT_EQ(values("detection").at("median rounds"), "4");
  EXPECT_EQ(values("detection").at("median full scores"), "87");
}

TEST_F(Diagnostics, DropsByCauseWarnWhileFramesAreBad) {
  health.drops = {{"rejected: depth", 7}};
  EXPECT_EQ(status("drops").level, DiagnosticStatus::kOk);  // that was long ago
  EXPECT_EQ(values("drops").at("rejected: depth"), "7");
  health.rates.frames_bad = 0.5;
  EXPECT_EQ(status("drops").level, DiagnosticStatus::kWarn);
}

TEST_F(Diagnostics, RefusedRequestsAndAnEmptyLibraryAreSeen) {
  EXPECT_EQ(status("queue").level, DiagnosticStatus::kOk);
  health.rates.requests_refused = 1;
  EXPECT_EQ(status("queue").level, DiagnosticStatus::kWarn);
  health.rates = {};
  health.losses = {.refused = 9, .malformed = 1, .lost = 2, .replies_dropped = 3};
  EXPECT_EQ(status("queue").level, DiagnosticStatus::kOk);  // that was long ago
  EXPECT_EQ(values("queue").at("requests malformed"), "1");
  EXPECT_EQ(values("queue").at("requests lost by DDS"), "2");
  EXPECT_EQ(values("queue").at("replies not delivered"), "3");
  health.rates.requests_lost = 0.1;
  EXPECT_EQ(status("queue").level, DiagnosticStatus::kWarn);
  EXPECT_EQ(status("models").level, DiagnosticStatus::kOk);
  health.status.model_count = 0;
  EXPECT_EQ(status("models").level, DiagnosticStatus::kError);
  EXPECT_EQ(status("detection").level, DiagnosticStatus::kError);
}

TEST_F(Diagnostics, EverySourceHasALine) {
  SourceReport report;
  report.name = "kinect";
  report.hardware_id = "A00361";
  report.level = DiagnosticStatus::kError;
  report.message = "the device is gone";
  report.values = {{"frames", "12"}};
  health.sources = {report};
  EXPECT_EQ(status("kinect").level, DiagnosticStatus::kError);
  EXPECT_EQ(status("kinect").hardware_id, "A00361");
  EXPECT_EQ(values("kinect").at("frames"), "12");
}

}  // namespace
}  // namespace bpa::server
