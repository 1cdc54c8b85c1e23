// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/distance_transform.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa {
namespace {

TEST(NearestMarkedCells, AreThoseOfASearch) {
  for (const Eigen::Vector3i& size : {Eigen::Vector3i(13, 7, 5), Eigen::Vector3i(40, 31, 1),
                                      Eigen::Vector3i(1, 1, 9), Eigen::Vector3i(1, 1, 1)}) {
    RandomStream random(7, static_cast<std::uint64_t>(size.x()));
    std::vector<std::uint8_t> marked(static_cast<std::size_t>(size.prod()), 0);
    const auto place = [&size](std::size_t c) {
      const int i = static_cast<int>(c);
      return Eigen::Vector3i(i % size.x(), i / size.x() % size.y(), i / size.x() / size.y());
    };
    for (auto& m : marked) m = random.uniform() < 0.04;
    marked[marked.size() / 2] = 1;
    const auto nearest = nearest_marked_cells(marked, size);
    for (std::size_t c = 0; c < marked.size(); ++c) {
      int best = 1 << 30;
      for (std::size_t other = 0; other < marked.size(); ++other) {
        if (marked[other]) best = std::min(best, (place(c) - place(other)).squaredNorm());
      }
      ASSERT_GE(nearest[c], 0);
      ASSERT_EQ(marked[static_cast<std::size_t>(nearest[c])], 1);
      ASSERT_EQ((place(c) - place(static_cast<std::size_t>(nearest[c]))).squaredNorm(), best);
    }
  }
}

TEST(NearestMarkedCells, OfNoneAreNone) {
  for (const std::int32_t c : nearest_marked_cells({0, 0, 0, 0, 0, 0}, {3, 2, 1})) EXPECT_EQ(c, -1);
}

TEST(DistanceTransform, GivesTheNearestPoint) {
  RandomStream random(3);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 800; ++i) {  // a sphere, so that its middle is equally far from all
    const Eigen::Vector3d d =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    points.push_back((0.05 * d).cast<float>());
  }
  constexpr float kCell = 0.004f, kMargin = 0.03f;
  const DistanceTransform t = distance_transform(points, kCell, kMargin);
  EXPECT_EQ(t.cell, kCell);
  for (int trial = 0; trial < 3000; ++trial) {
    const auto draw = [&random] { return static_cast<float>(random.uniform(-0.079, 0.079)); };
    const Eigen::Vector3f query(draw(), draw(), draw());
    const int found = t.nearest_to(query);
    ASSERT_GE(found, 0);
    float best = 1;
    for (const Eigen::Vector3f& p : points) best = std::min(best, (p - query).norm());
    // From the query to the centre and back, and the cell that the header allows.
    const float slack = (std::sqrt(3.0f) + 1) * kCell;
    EXPECT_LT((points[static_cast<std::size_t>(found)] - query).norm(), best + slack);
    const Eigen::Vector3f centre =
        t.low + kCell * (((query - t.low) / kCell).array().floor() + 0.5f).matrix();
    float best_of_centre = 1;
    for (const Eigen::Vector3f& p : points)
      best_of_centre = std::min(best_of_centre, (p - centre).norm());
    EXPECT_LT((points[static_cast<std::size_t>(found)] - centre).norm(), best_of_centre + kCell);
  }
  EXPECT_EQ(t.nearest_to({0.2f, 0, 0}), -1);
  EXPECT_EQ(t.nearest_to({0, -0.2f, 0}), -1);
  EXPECT_EQ(t.nearest_to({0, std::nanf(""), 0}), -1);
}

TEST(DistanceTransform, OfLargeObjectsHasLargerCells) {
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}, {1, 1, 1}};
  const DistanceTransform t = distance_transform(points, 0.004f, 0.03f, 50000);
  EXPECT_LE(t.nearest.size(), 50000u);
  EXPECT_GT(t.cell, 0.02f);
  EXPECT_EQ(t.nearest_to({0.1f, 0.2f, 0.1f}), 0);
  EXPECT_EQ(t.nearest_to({0.9f, 0.8f, 1.0f}), 1);
}

}  // namespace
}  // namespace bpa
