// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/segment_scores.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/features/edges.hpp"
#include "core/score/likelihood.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::score {
namespace {

class SegmentScores : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::l_model(); }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override {
    rendered_ = test::render(
        test::together({test::table(test::kCameraFromWorld)}, test::l_solids(test::kTruth)),
        test::kinect_camera(), 1, 8);
    map_ = surface_map(rendered_.frame, {});
  }
  bool on_object(std::size_t i) const { return rendered_.solid[rendered_.index_of(map_, i)] >= 1; }
  std::vector<SegmentMatch> match(const segment::Segmentation& segments, const Pose& pose,
                                  const SegmentMatchOptions& options = {}) const {
    const PredictedSurface predicted = predict_surface(make_check_image(map_), *model_, pose);
    return match_segments(segments, map_, *model_, pose, predicted, options);
  }
  // A segmentation by a rule: the number of the segment of each pixel.
  template <class Rule>
  segment::Segmentation segments_by(const Rule& rule, int count) const {
    segment::Segmentation out;
    out.labels = Image<std::int32_t>(map_.width(), map_.height(), -1);
    out.segments.resize(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < map_.size(); ++i) {
      if (map_.depth[i] <= 0 || map_.normals[i].squaredNorm() == 0) continue;
      out.labels[i] = rule(i);
      out.segments[static_cast<std::size_t>(rule(i))].pixels.push_back(
          static_cast<std::uint32_t>(i));
    }
    return out;
  }

  test::SolidImage rendered_;
  SurfaceMap map_;
  static inline std::shared_ptr<const ObjectModel> model_;
};

TEST_F(SegmentScores, TheObjectsOwnSegmentBelongsToIt) {
  const segment::Segmentation segments =
      segments_by([&](std::size_t i) { return on_object(i) ? 1 : 0; }, 2);
  const std::vector<SegmentMatch> matches = match(segments, test::kTruth, {.points = 400});
  ASSERT_FALSE(matches.empty());
  const SegmentMatch& own = matches.back();
  EXPECT_EQ(own.segment, 1);
  EXPECT_GT(own.probability, 0.7) << "but for the creases";
  EXPECT_GT(own.distance, -0.05);
  EXPECT_GT(own.explained, 0.85 * static_cast<double>(segments.segments[1].pixels.size()));
  if (matches.size() > 1) {
    EXPECT_LT(matches.front().probability, 0.1) << "the table's";
    EXPECT_LT(matches.front().distance, -0.8);
    EXPECT_LT(10 * matches.front().explained, own.explained);
  }
  EXPECT_GT(segment_score(matches), -0.15);
}

// Of a segment that is half table, half the points are on the model.
TEST_F(SegmentScores, ProbabilityIsTheShareOnTheModel) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < map_.size(); ++i) size += on_object(i);
  std::size_t taken = 0;
  std::vector<int> rule(map_.size(), 0);
  for (std::size_t i = 0; i < map_.size(); ++i) {
    const bool far_table = !on_object(i) && i % 320 < 60 && map_.depth[i] > 0 &&
                           map_.normals[i].squaredNorm() > 0 && taken < size;
    taken += far_table;
    rule[i] = on_object(i) || far_table;
  }
  ASSERT_EQ(taken, size);
  const segment::Segmentation own =
      segments_by([&](std::size_t i) { return on_object(i) ? 1 : 0; }, 2);
  const segment::Segmentation mixed = segments_by([&](std::size_t i) { return rule[i]; }, 2);
  const SegmentMatch pure = match(own, test::kTruth, {.points = 100000}).back();
  const SegmentMatch half = match(mixed, test::kTruth, {.points = 100000}).back();
  EXPECT_NEAR(half.probability, 0.5 * pure.probability, 0.01);
  EXPECT_NEAR(half.distance, 0.5 * (pure.distance - 1), 0.01);
  EXPECT_NEAR(match(mixed, test::kTruth).back().probability, half.probability, 0.2) << "30 points";
}

TEST_F(SegmentScores, TruthScoresHigherThanWhatIsBesideIt) {
  const features::SceneEdges edges = features::scene_edges(map_, {});
  const segment::Segmentation segments = segment::super_pixels(map_, {}, edges.likelihood);
  const std::vector<SegmentMatch> truth = match(segments, test::kTruth);
  EXPECT_GT(segment_score(truth), -0.08);
  EXPECT_GT(segment_affinity_score(segments, truth), -0.35);
  double distance = 0, affinity = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto other = match(segments, test::disturbed(test::kTruth, 0.02, 0.4, seed));
    EXPECT_LT(segment_score(other), segment_score(truth));
    distance += segment_score(other) / 20;
    affinity += segment_affinity_score(segments, other) / 20;
  }
  EXPECT_LT(distance, segment_score(truth) - 0.1);
  EXPECT_LT(affinity, segment_affinity_score(segments, truth) - 0.1);
}

TEST_F(SegmentScores, NothingTouched) {
  const segment::Segmentation segments = segments_by([](std::size_t) { return 0; }, 1);
  const auto none = match(segments, {test::kTruth.rotation, {0, 0, -1}});
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(segment_score(none), -1);
  EXPECT_EQ(segment_affinity_score(segments, none), -1);
}

TEST(SegmentScore, IsTheWeightedMean) {
  EXPECT_NEAR(segment_score({{0, 30, 1, -0.1}, {4, 10, 0.2, -0.9}}), -0.3, 1e-12);
}

TEST(SegmentAffinityScore, ClosedForms) {
  segment::Segmentation two;
  two.segments.resize(3);
  two.pairs = {{0, 1, 7, 0, 0, 0.3f}};
  const auto score = [&](double first, double second) {
    return segment_affinity_score(two, {{0, 1, first, 0}, {1, 1, second, 0}});
  };
  EXPECT_NEAR(score(1, 1), truncated_log(0.3, 0.02), 1e-6);
  EXPECT_NEAR(score(1, 0), truncated_log(0.7, 0.02), 1e-6);
  EXPECT_NEAR(score(0, 1), truncated_log(0.7, 0.02), 1e-6);
  EXPECT_EQ(score(0, 0), -1);
  // Both with 1/4, one with 1/2.
  EXPECT_NEAR(score(0.5, 0.5),
              (truncated_log(0.3, 0.02) * 0.25 + truncated_log(0.7, 0.02) * 0.5) / 0.75, 1e-6);
  // A second contact of a sure pair counts by its length.
  two.pairs.push_back({1, 2, 21, 0, 0, 0.9f});
  EXPECT_NEAR(segment_affinity_score(two, {{0, 1, 1, 0}, {1, 1, 1, 0}, {2, 1, 1, 0}}),
              0.25 * truncated_log(0.3, 0.02) + 0.75 * truncated_log(0.9, 0.02), 1e-6);
}

}  // namespace
}  // namespace bpa::score
