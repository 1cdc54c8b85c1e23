// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "core/segment/super_pixels.hpp"

namespace bpa::segment {
namespace {

// Two pieces of surface in the x-z plane: where they are, and the angle of their normals to z.
Segment piece(float x, float z, double angle) {
  Segment segment;
  segment.mean_position = {x, 0, z};
  segment.mean_normal = {static_cast<float>(std::sin(angle)), 0,
                         static_cast<float>(std::cos(angle))};
  return segment;
}

constexpr SegmentPair kTouching{0, 1, 10, 0, 0, 0};

TEST(SegmentAffinity, OfOnePlaneIsOne) {
  EXPECT_NEAR(segment_affinity(piece(0, 0, 0), piece(0.02f, 0, 0), kTouching), 1, 1e-5);
}

TEST(SegmentAffinity, OfABallIsThatOfItsAngle) {
  // Places on a ball at angle a have normals at angle a: the chord is symmetric to both.
  for (const double a : {0.1, 0.3, 0.6}) {
    const Segment second =
        piece(static_cast<float>(std::sin(a)), static_cast<float>(std::cos(a)), a);
    const double bulge = 80 * M_PI / 180;
    EXPECT_NEAR(segment_affinity(piece(0, 1, 0), second, kTouching),
                std::exp(-0.5 * a * a / (bulge * bulge)), 1e-4);
  }
}

TEST(SegmentAffinity, HollowsPartMoreThanBulges) {
  const float bulge = segment_affinity(piece(0, 0, -0.5), piece(0.02f, 0, 0.5), kTouching);
  const float hollow = segment_affinity(piece(0, 0, 0.5), piece(0.02f, 0, -0.5), kTouching);
  const double unit = 40 * M_PI / 180;
  EXPECT_NEAR(hollow, std::exp(-0.5 / (unit * unit)), 1e-4);
  EXPECT_NEAR(bulge, std::exp(-0.5 / (4 * unit * unit)), 1e-4);
}

TEST(SegmentAffinity, StepsEdgesAndBreaksPart) {
  const Segment low = piece(0, 0, 0), high = piece(0.02f, 0.02f, 0), beside = piece(0.02f, 0, 0);
  // The line between the two rises by 45 degrees.
  EXPECT_NEAR(segment_affinity(low, high, kTouching), std::exp(-0.5 * 45 * 45 / (80.0 * 80)), 1e-4);
  SegmentPair pair = kTouching;
  pair.edge = 0.4f;
  EXPECT_NEAR(segment_affinity(low, beside, pair), std::exp(-0.5), 1e-4);
  pair.edge = 0;
  pair.breaks = 7;
  EXPECT_NEAR(segment_affinity(low, beside, pair), 0.3, 1e-4);
  pair.contact = 0;
  EXPECT_EQ(segment_affinity(low, beside, pair), 0);
}

TEST(SegmentAffinity, IsSymmetric) {
  const Segment a = piece(0, 0, 0.2), b = piece(0.03f, 0.01f, -0.4);
  EXPECT_FLOAT_EQ(segment_affinity(a, b, kTouching), segment_affinity(b, a, kTouching));
}

}  // namespace
}  // namespace bpa::segment
