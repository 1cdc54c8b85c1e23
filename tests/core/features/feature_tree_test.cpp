// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/features/fpfh.hpp"

namespace bpa::features {
namespace {

std::vector<Fpfh> random_features(int count, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<Fpfh> features(static_cast<std::size_t>(count));
  for (Fpfh& feature : features) {
    for (float& value : feature) value = static_cast<float>(random.uniform(0, 100));
  }
  return features;
}

double squared_distance(const Fpfh& a, const Fpfh& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    sum += (static_cast<double>(a[k]) - b[k]) * (static_cast<double>(a[k]) - b[k]);
  }
  return sum;
}

std::vector<double> all_distances(const std::vector<Fpfh>& features, const Fpfh& query) {
  std::vector<double> distances;
  for (const Fpfh& feature : features) distances.push_back(squared_distance(feature, query));
  std::sort(distances.begin(), distances.end());
  return distances;
}

void expect_nearest(const std::vector<Fpfh>& features, const std::vector<Fpfh>& queries, int count,
                    int num_threads) {
  const FeatureTree tree(features);
  const auto matches = tree.nearest(queries, count, num_threads);
  ASSERT_EQ(matches.size(), queries.size() * static_cast<std::size_t>(count));
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const auto distances = all_distances(features, queries[q]);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      const auto& match = matches[q * static_cast<std::size_t>(count) + k];
      if (k >= features.size()) {
        EXPECT_EQ(match.index, -1);
        continue;
      }
      ASSERT_GE(match.index, 0);
      const Fpfh& found = features[static_cast<std::size_t>(match.index)];
      EXPECT_NEAR(squared_distance(found, queries[q]), distances[k], 1e-4 * distances[k] + 1e-6);
      EXPECT_NEAR(match.squared_distance, distances[k], 1e-4 * distances[k] + 1e-6);
    }
  }
}

class FeatureTreeOf : public ::testing::TestWithParam<int> {};

TEST_P(FeatureTreeOf, FindsWhatLookingAtAllFeaturesFinds) {
  const auto features = random_features(GetParam(), 1);
  auto queries = random_features(150, 2);
  for (std::size_t k = 0; k < std::min<std::size_t>(20, features.size()); ++k) {
    queries.push_back(features[k]);
  }
  for (const int count : {1, 2, 5}) expect_nearest(features, queries, count, 1);
}

INSTANTIATE_TEST_SUITE_P(Sizes, FeatureTreeOf, ::testing::Values(0, 1, 2, 16, 700));

TEST(FeatureTree, RepeatedFeaturesAreEachFound) {
  const auto features = random_features(10, 3);
  auto thrice = features;
  for (int k = 0; k < 2; ++k) thrice.insert(thrice.end(), features.begin(), features.end());
  const FeatureTree tree(thrice);
  const auto matches = tree.nearest(std::span(features).first(1), 3, 1);
  std::vector<int> found{matches[0].index, matches[1].index, matches[2].index};
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, (std::vector<int>{0, 10, 20}));
}

TEST(FeatureTree, NoQueriesNoMatches) {
  EXPECT_TRUE(FeatureTree(random_features(5, 1)).nearest({}, 2, 4).empty());
}

TEST(FeatureTree, NumberOfThreadsDoesNotMatter) {
  const auto features = random_features(500, 4);
  const auto queries = random_features(300, 5);
  const FeatureTree tree(features);
  const auto one = tree.nearest(queries, 3, 1);
  for (const int threads : {2, 8}) {
    const auto many = tree.nearest(queries, 3, threads);
    for (std::size_t k = 0; k < one.size(); ++k) {
      ASSERT_EQ(one[k].index, many[k].index);
      ASSERT_EQ(one[k].squared_distance, many[k].squared_distance);
    }
  }
}

TEST(FeatureTree, KeepsItsOwnCopy) {
  auto features = random_features(50, 6);
  const auto original = features;
  FeatureTree tree(features);
  for (Fpfh& feature : features) feature.fill(0);
  FeatureTree moved = std::move(tree);
  EXPECT_EQ(moved.nearest(std::span(original).subspan(7, 1), 1, 1)[0].index, 7);
}

}  // namespace
}  // namespace bpa::features
