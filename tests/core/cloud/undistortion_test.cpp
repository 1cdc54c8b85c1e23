// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/undistortion.hpp"

#include <gtest/gtest.h>

namespace bpa {
namespace {

TEST(Undistortion, MovesPixelsAlongTheRadius) {
  const Camera camera{101, 101, 100, 100, 50, 50};
  // k1 alone: a point at radius r is seen at r (1 + k1 r^2); here r = 0.4, so 40 -> 43.2 pixels.
  const auto map = undistortion_map(camera, {false, {0.5}});
  EXPECT_EQ(map[50 * 101 + 50], 50 * 101 + 50);
  EXPECT_EQ(map[50 * 101 + 90], 50 * 101 + 93);
  EXPECT_EQ(map[90 * 101 + 50], 93 * 101 + 50);
  EXPECT_EQ(map[0], -1);  // seen outside
}

}  // namespace
}  // namespace bpa
