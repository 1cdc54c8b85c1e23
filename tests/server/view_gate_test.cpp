// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/view_gate.hpp"

#include <cstdint>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace bpa::server {
namespace {

struct Stamped {
  std::int64_t stamp_ns = 0;
  std::string frame_id;
};

TEST(ViewGate, FramesAreOfOneTimeAndEachIsUsedOrDisplacedOrWaits) {
  constexpr std::int64_t kTolerance = 10;
  ViewGate<Stamped> gate({"a", "b", "c"}, kTolerance);
  EXPECT_TRUE(gate.takes("b"));
  EXPECT_FALSE(gate.takes("d"));
  std::mt19937 random(1);
  std::size_t displaced = 0, used = 0;
  constexpr std::size_t kFrames = 3000;
  for (std::size_t i = 0; i < kFrames; ++i) {
    const std::string camera(1, static_cast<char>('a' + random() % 3));
    const auto stamp = static_cast<std::int64_t>(5 * i + random() % 5);
    const auto views = gate.add({stamp, camera}, displaced);
    if (!views) continue;
    used += views->size();
    ASSERT_EQ(views->size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ((*views)[k].frame_id, std::string(1, static_cast<char>('a' + k)));
      EXPECT_LE(std::abs((*views)[k].stamp_ns - stamp), kTolerance);
    }
  }
  EXPECT_GT(used, 0U);
  EXPECT_LE(used + displaced, kFrames);
  EXPECT_GE(used + displaced + 3, kFrames);  // at most one of each camera waits
}

}  // namespace
}  // namespace bpa::server
