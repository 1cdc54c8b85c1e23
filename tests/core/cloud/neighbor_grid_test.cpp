// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/neighbor_grid.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa {
namespace {

using Points = std::vector<Eigen::Vector3f>;
using Found = std::vector<std::pair<int, float>>;

Found by_grid(const NeighborGrid& grid, const Eigen::Vector3f& query) {
  Found found;
  grid.for_each_neighbor(query, [&](int i, float squared) { found.push_back({i, squared}); });
  std::sort(found.begin(), found.end());
  return found;
}

Found by_looking_at_all(const Points& points, const Eigen::Vector3f& query, float radius) {
  Found found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float squared = (points[i] - query).squaredNorm();
    if (squared <= radius * radius) found.push_back({static_cast<int>(i), squared});
  }
  return found;
}

Eigen::Vector3f random_point(RandomStream& random, float size) {
  const auto s = static_cast<double>(size);
  return Eigen::Vector3d(random.uniform(-s, s), random.uniform(-s, s), random.uniform(-s, s))
      .cast<float>();
}

struct Case {
  const char* name;
  Points (*make)(RandomStream&);
};

Points random_cloud(RandomStream& random) {
  Points points(800);
  for (auto& p : points) p = random_point(random, 0.2f);
  return points;
}
Points plane_on_cell_borders(RandomStream&) {
  Points points;
  for (int y = -15; y < 15; ++y) {
    for (int x = -15; x < 15; ++x) points.push_back(0.025f * Eigen::Vector3f(x, y, 0));
  }
  return points;
}
Points duplicates(RandomStream& random) {
  Points points = random_cloud(random);
  points.resize(60);
  for (int k = 0; k < 3; ++k) points.insert(points.end(), points.begin(), points.begin() + 60);
  return points;
}
Points one_place(RandomStream&) { return Points(50, Eigen::Vector3f(-0.1f, 0.05f, 0.7f)); }
Points far_apart(RandomStream& random) {
  Points points(200);
  for (auto& p : points) p = random_point(random, 60.0f);
  for (int k = 0; k < 100; ++k) points.push_back(points[0] + random_point(random, 0.05f));
  return points;
}
Points none(RandomStream&) { return {}; }
Points one(RandomStream& random) { return {random_point(random, 0.1f)}; }
Points two(RandomStream& random) { return {random_point(random, 0.02f), {0, 0, 0}}; }

class NeighborGridOf : public ::testing::TestWithParam<Case> {};

TEST_P(NeighborGridOf, FindsWhatLookingAtAllPointsFinds) {
  RandomStream random(7);
  const Points points = GetParam().make(random);
  for (const float radius : {0.004f, 0.025f, 0.11f, 2.0f}) {
    const NeighborGrid grid(points, radius);
    for (int k = 0; k < 150; ++k) {
      const bool inside = k % 2 == 0 && !points.empty();
      const Eigen::Vector3f query =
          inside ? points[static_cast<std::size_t>(random.index(static_cast<int>(points.size())))]
                 : random_point(random, 0.3f);
      EXPECT_EQ(by_grid(grid, query), by_looking_at_all(points, query, radius)) << radius;
    }
  }
}

TEST(NeighborGrid, PointsBeyondAllCellsAreFoundByNobody) {
  const float huge = 1e30f, nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Eigen::Vector3f> points = {
      {0, 0, 0}, {huge, 0, 0}, {0, -huge, 0}, {nan, nan, nan}, {0.01f, 0, 0}};
  const NeighborGrid grid(points, 0.02f);
  EXPECT_EQ(by_grid(grid, {0, 0, 0}).size(), 2u);
  EXPECT_EQ(by_grid(grid, {nan, 0, 0}).size(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Clouds, NeighborGridOf,
                         ::testing::Values(Case{"Random", random_cloud},
                                           Case{"PlaneOnCellBorders", plane_on_cell_borders},
                                           Case{"Duplicates", duplicates},
                                           Case{"OnePlace", one_place}, Case{"FarApart", far_apart},
                                           Case{"None", none}, Case{"One", one}, Case{"Two", two}),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace bpa
