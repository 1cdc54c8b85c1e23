// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/frame_fusion.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/cloud/surface_map.hpp"
#include "tests/support/solid_scene.hpp"

namespace bpa {
namespace {

AgreedDepth agreed(std::vector<float> depths) { return agreed_depth(depths); }

/// The same by its definition: sort, take the middle, average what is near it.
AgreedDepth by_sorting(std::vector<float> depths) {
  std::sort(depths.begin(), depths.end());
  AgreedDepth out;
  out.median = depths[(depths.size() - 1) / 2];
  const float far = kFusionAgreement * depth_noise(out.median);
  double sum = 0;
  for (const float depth : depths) {
    if (depth < out.median - far || depth > out.median + far) continue;
    sum += static_cast<double>(depth);
    ++out.agreeing;
  }
  out.mean = static_cast<float>(sum / out.agreeing);
  return out;
}

TEST(AgreedDepth, IsTheMeanWithoutThoseThatDisagree) {
  // At 1 m the sensor's noise is 1.884 mm: what is within 5.652 mm of the median agrees.
  const AgreedDepth all = agreed({1.002f, 0.999f, 1.0f, 1.005f});
  EXPECT_FLOAT_EQ(all.median, 1.0f);
  EXPECT_FLOAT_EQ(all.mean, 1.0015f);
  EXPECT_EQ(all.agreeing, 4);
  const AgreedDepth some = agreed({1.002f, 1.3f, 0.999f, 1.007f, 1.0f, 0.7f, 0.9943f});
  EXPECT_FLOAT_EQ(some.median, 1.0f);
  EXPECT_FLOAT_EQ(some.mean, (0.999f + 1.0f + 1.002f) / 3);
  EXPECT_EQ(some.agreeing, 3);
  const AgreedDepth one = agreed({2.0f});
  EXPECT_EQ(one.mean, 2.0f);
  EXPECT_EQ(one.agreeing, 1);
}

TEST(AgreedDepth, IsNeverBetweenTwoSurfaces) {
  for (const auto& depths : {std::vector<float>{1.0f, 1.2f}, {1.2f, 1.0f}, {1, 1.2f, 1.2f, 1}}) {
    EXPECT_EQ(agreed(depths).mean, 1.0f);
  }
}

TEST(AgreedDepth, IsWhatSortingGives) {
  RandomStream random(4, 0);
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<float> depths;
    const auto base = static_cast<float>(random.uniform(0.5, 3));
    for (int i = 1 + trial % 9; i > 0; --i) {
      const bool off = random.uniform(0, 1) < 0.2;
      const auto error = static_cast<float>(random.normal());
      depths.push_back(base + (off ? 0.1f : depth_noise(base)) * error);
    }
    const AgreedDepth expected = by_sorting(depths);
    const AgreedDepth found = agreed(depths);
    ASSERT_EQ(found.median, expected.median);
    ASSERT_EQ(found.agreeing, expected.agreeing);
    ASSERT_NEAR(found.mean, expected.mean, 1e-6f);
  }
}

/// Two bricks on a table; the first one may lie elsewhere.
class FrameFusionOf : public testing::Test {
 protected:
  static Frame seen(double shift, float noise, std::uint64_t seed) {
    const Eigen::Vector3d half(0.06, 0.04, 0.025);
    const auto brick = [&](double x, double y) {
      return test::Solid{test::Solid::Kind::box, half,
                         camera_from_world_ * test::standing_at(x, y, half.z(), 0.3)};
    };
    return test::render({test::table(camera_from_world_), brick(shift, 0), brick(-0.15, 0.1)},
                        test::kinect_camera(160), noise, seed)
        .frame;
  }
  /// Root mean square of the error of depth where there is one.
  static double error_of(const Frame& frame, const Frame& truth) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < truth.depth.size(); ++i) {
      if (frame.depth[i] == 0 || truth.depth[i] == 0) continue;
      sum += std::pow(static_cast<double>(frame.depth[i]) - static_cast<double>(truth.depth[i]), 2);
      ++count;
    }
    EXPECT_GT(count, 10000);
    return std::sqrt(sum / count);
  }

  static inline const Pose camera_from_world_ = test::look_at({0.1, -0.6, 0.5}, {0, 0, 0});
};

TEST_F(FrameFusionOf, StillScenesComeCloserToTheTruthWithEveryFrame) {
  const Frame truth = seen(0.05, 0, 0);
  FrameFusion fusion(9);
  double single = 0;
  for (int n = 1; n <= 12; ++n) {
    const FusedFrame fused = fusion.add(seen(0.05, 1, static_cast<std::uint64_t>(n)));
    EXPECT_EQ(fused.restart, "");
    EXPECT_EQ(fused.frame.fused, std::min(n, 9));
    const double error = error_of(fused.frame, truth);
    if (n == 1) single = error;
    // The mean of n is off by 1 / sqrt(n); of the newest that disagree by chance, a little more.
    const double expected = single / std::sqrt(std::min(n, 9));
    EXPECT_GT(error, 0.95 * expected) << n;
    EXPECT_LT(error, 1.25 * expected) << n;
  }
}

TEST_F(FrameFusionOf, AThingThatMovesIsWhereItIsNow) {
  FrameFusion fusion(5);
  for (std::uint64_t n = 0; n < 4; ++n) fusion.add(seen(0.0, 1, n));
  const Frame newest = seen(0.15, 1, 9);
  const FusedFrame fused = fusion.add(newest);
  EXPECT_EQ(fused.restart, "");
  EXPECT_EQ(fused.frame.fused, 5);
  const Frame before = seen(0.0, 0, 0), now = seen(0.15, 0, 0);
  double moved = 0, error = 0, single = 0;
  for (std::size_t i = 0; i < now.depth.size(); ++i) {
    if (std::abs(before.depth[i] - now.depth[i]) > 0.02f) {
      ASSERT_EQ(fused.frame.depth[i], newest.depth[i]) << i;
      ++moved;
    } else if (before.depth[i] == now.depth[i]) {
      error += std::abs(fused.frame.depth[i] - now.depth[i]);
      single += std::abs(newest.depth[i] - now.depth[i]);
    }
  }
  EXPECT_GT(moved, 300);
  EXPECT_LT(error, 0.6 * single) << "of what stayed";
  // Once most frames show it there, they are combined.
  Frame last = fusion.add(seen(0.15, 1, 10)).frame;
  for (std::uint64_t n = 11; n < 14; ++n) last = fusion.add(seen(0.15, 1, n)).frame;
  EXPECT_LT(error_of(last, now), 0.6 * error_of(newest, now));
}

TEST_F(FrameFusionOf, HolesAreFilledByFramesThatAgree) {
  const Frame full = seen(0.0, 0, 0);
  const std::size_t middle = full.depth.size() / 2 + 80;
  const auto last_of = [&](const std::vector<float>& depths) {
    FrameFusion fusion(5);
    Frame last;
    for (const float depth : depths) {
      Frame frame = full;
      frame.depth[middle] = depth;
      last = fusion.add(std::move(frame)).frame;
    }
    return last.depth[middle];
  };
  EXPECT_FLOAT_EQ(last_of({0.700f, 0.702f, 0.701f, 0}), 0.701f);
  EXPECT_EQ(last_of({0.7f, 0}), 0.7f);
  EXPECT_EQ(last_of({0.7f, 0, 0, 0}), 0) << "most have none";
  EXPECT_EQ(last_of({0.7f, 0.9f, 0}), 0) << "they do not agree";
  EXPECT_FLOAT_EQ(last_of({0, 0, 0.7f}), 0.7f);
  EXPECT_EQ(last_of({0, 0, 0}), 0);
}

TEST_F(FrameFusionOf, KeepsAllElseOfTheNewest) {
  FrameFusion fusion(3);
  Frame frame = seen(0, 1, 1);
  fusion.add(frame);
  frame = seen(0, 1, 2);
  frame.stamp_ns = 77;
  frame.color.assign(3 * frame.depth.size(), 9);
  frame.roi = {1, 2, 30, 40};
  frame.mask.assign(frame.depth.size(), 1);
  const Frame fused = fusion.add(frame).frame;
  EXPECT_EQ(fused.stamp_ns, 77);
  EXPECT_EQ(fused.color, frame.color);
  EXPECT_EQ(fused.mask, frame.mask);
  EXPECT_EQ(fused.roi.height, 40);
  EXPECT_EQ(fused.frame_id, frame.frame_id);
  EXPECT_NE(fused.depth, frame.depth);
}

TEST_F(FrameFusionOf, BeginsAnewWithAnotherCamera) {
  const Frame base = seen(0, 1, 1);
  const auto reason = [&](auto&& change) {
    FrameFusion fusion(3);
    fusion.add(base);
    Frame other = base;
    change(other);
    const FusedFrame fused = fusion.add(other);
    EXPECT_EQ(fused.frame.fused, 1);
    EXPECT_EQ(fused.frame.depth, other.depth);
    EXPECT_EQ(fusion.add(other).frame.fused, 2);
    return fused.restart;
  };
  EXPECT_EQ(reason([](Frame& f) { f.camera.fx = 600; }), "camera.fx changed from 131.25 to 600");
  EXPECT_EQ(reason([](Frame& f) { f.camera.cy += 1; }), "camera.cy changed from 59.5 to 60.5");
  EXPECT_EQ(reason([](Frame& f) { f.frame_id = "left"; }),
            "frame_id changed from \"camera\" to \"left\"");
  EXPECT_EQ(reason([](Frame& f) {
              f.camera.height = 60;
              f.depth.resize(160 * 60);
            }),
            "camera.height changed from 120 to 60");
}

TEST_F(FrameFusionOf, BeginsAnewWhenTheCameraMoves) {
  FrameFusion fusion(4);
  fusion.add(seen(0, 1, 1));
  fusion.add(seen(0, 1, 2));
  Frame nearer = seen(0, 1, 3);
  for (float& z : nearer.depth) z *= 0.97f;
  const FusedFrame fused = fusion.add(nearer);
  EXPECT_NE(fused.restart.find("% of the depths changed"), std::string::npos) << fused.restart;
  EXPECT_EQ(fused.frame.fused, 1);
  EXPECT_EQ(fused.frame.depth, nearer.depth);
  EXPECT_EQ(fusion.add(nearer).frame.fused, 2) << "of the new place";
}

TEST_F(FrameFusionOf, OneFrameIsLeftAsItIs) {
  FrameFusion fusion;
  for (std::uint64_t n = 0; n < 3; ++n) {
    const Frame frame = seen(0, 1, n);
    const FusedFrame fused = fusion.add(frame);
    EXPECT_EQ(fused.frame.depth, frame.depth);
    EXPECT_EQ(fused.frame.fused, 1);
    EXPECT_EQ(fused.restart, "");
  }
}

TEST_F(FrameFusionOf, TakesUpAnotherLength) {
  FrameFusion fusion(4);
  for (std::uint64_t n = 0; n < 4; ++n) fusion.add(seen(0, 1, n));
  fusion.set_max_frames(2);
  EXPECT_EQ(fusion.add(seen(0, 1, 5)).frame.fused, 2);
  fusion.set_max_frames(3);
  EXPECT_EQ(fusion.add(seen(0, 1, 6)).frame.fused, 3);
}

TEST_F(FrameFusionOf, FramesThatAreHeldCountAsThoseThatAreAdded) {
  FrameFusion added(4), held(4);
  for (std::uint64_t n = 0; n < 5; ++n) {
    added.add(seen(0, 1, n));
    EXPECT_EQ(held.hold(seen(0, 1, n)), "");
  }
  EXPECT_EQ(held.add(seen(0, 1, 5)).frame.depth, added.add(seen(0, 1, 5)).frame.depth);
  Frame other = seen(0, 1, 6);
  other.frame_id = "left";
  EXPECT_EQ(held.hold(other), "frame_id changed from \"camera\" to \"left\"");
  EXPECT_EQ(held.add(other).frame.fused, 2);
}

TEST_F(FrameFusionOf, IsTheSameForAnyThreads) {
  FrameFusion one(3), many(3);
  for (std::uint64_t n = 0; n < 3; ++n) {
    EXPECT_EQ(one.add(seen(0, 1, n), 1).frame.depth, many.add(seen(0, 1, n), 7).frame.depth);
  }
}

}  // namespace
}  // namespace bpa
