// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "ros/synchronizer.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/wall_messages.hpp"

namespace bpa::ros {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kPeriod = 33 * kMs;

class SynchronizerTest : public testing::Test {
 protected:
  explicit SynchronizerTest(SynchronizerOptions options = {}) : sync(options) {}

  void color(std::int64_t stamp) {
    sync.add_color(support::wall_color_image(stamp));
    drain();
  }
  void depth(std::int64_t stamp) {
    sync.add_depth(support::wall_depth_image(stamp));
    drain();
  }
  void info(std::int64_t stamp) {
    sync.add_info(support::wall_camera_info(stamp));
    drain();
  }
  void drain() {
    while (auto images = sync.next()) {
      depth_stamps.push_back(to_ns(header_of(*images->depth).stamp));
      color_stamps.push_back(images->color ? to_ns(header_of(*images->color).stamp) : -1);
    }
  }

  Synchronizer sync;
  std::vector<std::int64_t> depth_stamps, color_stamps;
};

TEST_F(SynchronizerTest, ExactStampsInAnyOrder) {
  const std::int64_t t = 1000 * kMs;
  color(t), depth(t), info(t);
  info(t + kPeriod), depth(t + kPeriod), color(t + kPeriod);
  depth(t + 2 * kPeriod), info(t + 2 * kPeriod), color(t + 2 * kPeriod);
  EXPECT_EQ(depth_stamps, (std::vector<std::int64_t>{t, t + kPeriod, t + 2 * kPeriod}));
  EXPECT_EQ(color_stamps, depth_stamps);
  EXPECT_EQ(sync.counts().exact, 3U);
  EXPECT_EQ(sync.counts().approximate, 0U);
  EXPECT_EQ(sync.counts().depth_without_color, 0U);
}

TEST_F(SynchronizerTest, NearStampsWaitUntilNoneCanBeNearer) {
  const std::int64_t t = 1000 * kMs;
  color(t - 5 * kMs), info(t), depth(t);
  EXPECT_TRUE(depth_stamps.empty());  // a colour image at t may still come
  color(t + 3 * kMs);
  ASSERT_EQ(depth_stamps.size(), 1U);
  EXPECT_EQ(color_stamps[0], t + 3 * kMs);  // the nearer one
  EXPECT_EQ(sync.counts().approximate, 1U);
  EXPECT_EQ(sync.counts().color_unused, 1U);
}

TEST_F(SynchronizerTest, ExactBeatsNear) {
  const std::int64_t t = 1000 * kMs;
  color(t - 2 * kMs), info(t), depth(t), color(t);
  ASSERT_EQ(color_stamps.size(), 1U);
  EXPECT_EQ(color_stamps[0], t);
  EXPECT_EQ(sync.counts().exact, 1U);
}

TEST_F(SynchronizerTest, StreamsThatNeverMeetAreCountedByCause) {
  for (int i = 0; i < 50; ++i) {
    const std::int64_t t = 1000 * kMs + i * kPeriod;
    depth(t), info(t), color(t + 500 * kMs);  // clocks that differ
  }
  const SyncCounts& counts = sync.counts();
  EXPECT_GE(counts.depth_without_color, 40U);
  EXPECT_EQ(counts.depth_without_info, 0U);
  EXPECT_GT(counts.nearest_miss_ns, 10 * kMs);
}

TEST_F(SynchronizerTest, MissingStreamsAreCountedByCause) {
  for (int i = 0; i < 30; ++i) {
    depth(1000 * kMs + i * kPeriod), color(1000 * kMs + i * kPeriod);
  }
  EXPECT_TRUE(depth_stamps.empty());
  EXPECT_EQ(sync.counts().depth_without_info, 20U);  // ten wait
  EXPECT_EQ(sync.counts().depth_without_color, 0U);
  EXPECT_EQ(sync.counts().nearest_miss_ns, 0);
}

TEST_F(SynchronizerTest, LostMessagesCostOnlyTheirSet) {
  for (int i = 0; i < 30; ++i) {
    const std::int64_t t = 1000 * kMs + i * kPeriod;
    info(t);
    if (i % 5 != 2) color(t);
    depth(t);
  }
  EXPECT_EQ(sync.counts().exact, 24U);
  EXPECT_EQ(sync.counts().depth_without_color, 6U);
  EXPECT_TRUE(std::is_sorted(depth_stamps.begin(), depth_stamps.end()));
}

TEST_F(SynchronizerTest, AClockThatJumpsBackStartsAgain) {
  const std::int64_t t = 100'000 * kMs;
  color(t), info(t), depth(t);
  const std::int64_t u = 1000 * kMs;
  color(u), info(u), depth(u);
  EXPECT_EQ(depth_stamps, (std::vector<std::int64_t>{t, u}));
  EXPECT_EQ(sync.counts().restarts, 1U);
}

class DepthOnly : public SynchronizerTest {
 protected:
  DepthOnly() : SynchronizerTest({false, 10 * kMs, 10}) {}
};

TEST_F(DepthOnly, NeedsNoColor) {
  depth(1000 * kMs), info(1000 * kMs);
  EXPECT_EQ(color_stamps, std::vector<std::int64_t>{-1});
}

}  // namespace
}  // namespace bpa::ros
