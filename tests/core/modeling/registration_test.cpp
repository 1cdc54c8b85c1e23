// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Boxes drawn face by face, laid onto each other from anywhere.
#include "core/modeling/registration.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/geometry/symmetry.hpp"

namespace bpa::modeling {
namespace {

// The faces of a box about the origin, but for its lower one: what a scan of it shows.
PointCloud open_box(const Eigen::Vector3f& half) {
  constexpr float kStep = 0.003f;
  PointCloud cloud;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      if (axis == 2 && side < 0) continue;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (float a = -half[u]; a <= half[u]; a += kStep) {
        for (float b = -half[v]; b <= half[v]; b += kStep) {
          Eigen::Vector3f p;
          p[axis] = side * half[axis], p[u] = a, p[v] = b;
          cloud.points.push_back(p);
          cloud.normals.push_back(side * Eigen::Vector3f::Unit(axis));
        }
      }
    }
  }
  return cloud;
}

PointCloud moved(const PointCloud& cloud, const Pose& pose) {
  PointCloud out = cloud;
  for (auto& p : out.points) p = (pose * p.cast<double>()).cast<float>();
  for (auto& n : out.normals) n = (pose.rotation * n.cast<double>()).cast<float>();
  return out;
}

const Pose kAway{rotation_from_vector(Eigen::Vector3d(0.7, -1.1, 0.4)), {0.3, -0.2, 0.6}};

TEST(Registration, PoseIsFound) {
  const PointCloud box = open_box({0.06f, 0.04f, 0.025f});
  const auto ways = register_surfaces(moved(box, kAway), box, {});
  ASSERT_FALSE(ways.empty());
  EXPECT_GT(ways.front().overlap, 0.99);
  EXPECT_LT(ways.front().rms, 0.0005);
  // Right, or turned by half.
  const Pose error = ways.front().target_from_source * kAway;
  const Eigen::Matrix3d r = error.matrix();
  EXPECT_GT(r(2, 2), 0.9999);
  EXPECT_GT(std::abs(r(0, 0)), 0.9999);
  EXPECT_LT(error.translation.norm(), 0.0005);
}

// The open side of one is the lid of the other: only the walls meet, which say nothing of height.
// Four ways lay it into itself, and thousands nearly so; this one must be found beside them.
TEST(Registration, WorseWaysFindRoomBesideManyBetterOnes) {
  const PointCloud box = open_box({0.042f, 0.042f, 0.016f});
  RegistrationOptions options;
  options.kept = 160;
  const auto ways = register_surfaces(moved(box, kAway), box, options);
  ASSERT_FALSE(ways.empty());
  EXPECT_GT(ways.front().overlap, 0.95);
  const bool found = std::any_of(ways.begin(), ways.end(), [](const Registration& way) {
    const Pose error = way.target_from_source * kAway;
    return error.matrix()(2, 2) < -0.999 && error.translation.head<2>().norm() < 0.0005 &&
           std::abs(error.translation.z()) < 0.004 && way.overlap > 0.4;
  });
  EXPECT_TRUE(found);
}

TEST(Registration, SameForAnyNumberOfThreadsAndEmptyForNothing) {
  const PointCloud box = open_box({0.06f, 0.04f, 0.025f});
  RegistrationOptions one, three;
  one.draws = three.draws = 300;
  one.num_threads = 1, three.num_threads = 3;
  const auto a = register_surfaces(moved(box, kAway), box, one);
  const auto b = register_surfaces(moved(box, kAway), box, three);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].overlap, b[i].overlap);
    EXPECT_EQ(a[i].target_from_source.translation, b[i].target_from_source.translation);
  }
  EXPECT_TRUE(register_surfaces({}, box, one).empty());
  EXPECT_TRUE(register_surfaces(box, {}, one).empty());
}

ModelSource model_of(const PointCloud& surface, double diameter) {
  ModelSource source;
  source.surface = surface;
  source.diameter = diameter;
  return source;
}

TEST(SameShape, OfABoxMovedAndNotOfAnotherBox) {
  const Eigen::Vector3f half(0.06f, 0.04f, 0.025f), other(0.063f, 0.041f, 0.0135f);
  const double diameter = 2 * static_cast<double>(half.norm());
  ASSERT_NEAR(2 * static_cast<double>(other.norm()) / diameter, 1, 0.03);
  const ModelSource box = model_of(open_box(half), diameter);
  EXPECT_TRUE(same_shape(box, model_of(moved(open_box(half), kAway), diameter)));
  EXPECT_FALSE(same_shape(box, model_of(moved(open_box(other), kAway), diameter)));
  EXPECT_FALSE(same_shape(box, model_of(moved(open_box(half), kAway), 1.05 * diameter)));
}

}  // namespace
}  // namespace bpa::modeling
