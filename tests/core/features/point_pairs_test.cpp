// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/features/pair_voting.hpp"
#include "core/geometry/pose.hpp"

namespace bpa::features {
namespace {

Eigen::Vector3f random_vector(RandomStream& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).cast<float>();
}

PointCloud random_oriented_points(int count, std::uint64_t seed) {
  RandomStream random(seed);
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    cloud.points.push_back(0.025f * random_vector(random));
    cloud.normals.push_back(random_vector(random).normalized());
  }
  return cloud;
}

Pose random_pose(std::uint64_t seed) {
  RandomStream random(seed);
  return {Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
              .normalized(),
          {random.normal(), random.normal(), random.normal()}};
}

PointCloud moved(const PointCloud& cloud, const Pose& pose) {
  PointCloud out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    out.points.push_back((pose * cloud.points[i].cast<double>()).cast<float>());
    out.normals.push_back((pose.rotation * cloud.normals[i].cast<double>()).cast<float>());
  }
  return out;
}

PointPairFeature feature_of(const PointCloud& cloud, std::size_t i, std::size_t j) {
  return point_pair_feature(cloud.points[i], cloud.normals[i], cloud.points[j], cloud.normals[j]);
}

TEST(PointPairs, FeatureOfAKnownPair) {
  const auto f = point_pair_feature({0, 0, 0}, Eigen::Vector3f::UnitZ(), {0.3f, 0, 0.3f},
                                    Eigen::Vector3f::UnitX());
  EXPECT_NEAR(f.distance, 0.3 * std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(f.angle_first, M_PI / 4, 1e-6);
  EXPECT_NEAR(f.angle_second, M_PI / 4, 1e-6);
  EXPECT_NEAR(f.angle_normals, M_PI / 2, 1e-6);
}

TEST(PointPairs, OppositeNormalsAlongTheLine) {
  const auto f = point_pair_feature({0, 0, 0}, -Eigen::Vector3f::UnitX(), {0.1f, 0, 0},
                                    Eigen::Vector3f::UnitX());
  EXPECT_NEAR(f.angle_first, M_PI, 1e-3);
  EXPECT_NEAR(f.angle_second, 0, 1e-3);
  EXPECT_NEAR(f.angle_normals, M_PI, 1e-3);
}

TEST(PointPairs, FeatureDoesNotChangeUnderRigidMotion) {
  const PointCloud cloud = random_oriented_points(40, 1);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const PointCloud other = moved(cloud, random_pose(seed));
    for (std::size_t i = 0; i < 40; ++i) {
      const auto a = feature_of(cloud, i, (i + 7) % 40);
      const auto b = feature_of(other, i, (i + 7) % 40);
      EXPECT_NEAR(a.distance, b.distance, 2e-6);
      EXPECT_NEAR(a.angle_first, b.angle_first, 1e-3);
      EXPECT_NEAR(a.angle_second, b.angle_second, 1e-3);
      EXPECT_NEAR(a.angle_normals, b.angle_normals, 1e-3);
    }
  }
}

TEST(PointPairs, CoplanarPairsSayNothing) {
  const Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
  const auto informative = [&](const Eigen::Vector3f& q, const Eigen::Vector3f& nq) {
    return fixes_pose(point_pair_feature({0, 0, 0}, up, q, nq));
  };
  EXPECT_FALSE(informative({0.05f, 0, 0}, up));
  EXPECT_FALSE(informative({0.05f, 0, 0.004f}, up));
  EXPECT_TRUE(informative({0.05f, 0, 0.05f}, up)) << "two steps of a stair";
  EXPECT_TRUE(informative({0.05f, 0, 0}, Eigen::Vector3f(0.6f, 0, 0.8f)));
  EXPECT_TRUE(informative({0.05f, 0, 0}, -up)) << "two sides";
}

constexpr float kDistanceStep = 0.006f;
constexpr float kAngleStep = 0.26179939f;

// What a table should hold, found the slow way: the pairs whose feature lies in the cell, or less
// than 15 % of a cell beside it.
bool belongs(float value, float step, int bins, float looked_up) {
  const auto bin = [&](float v) { return std::min(bins - 1, static_cast<int>(v / step)); };
  const auto lower = static_cast<float>(bin(looked_up)) * step;
  const bool last = bin(looked_up) == bins - 1;
  return value >= lower - 0.15f * step && (last || value <= lower + 1.15f * step);
}

std::multiset<int> expected_points(const PointCloud& cloud, const PointPairFeature& f) {
  std::multiset<int> out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      const auto g = feature_of(cloud, i, j);
      if (i == j || g.distance < kDistanceStep || !fixes_pose(g)) continue;
      if (belongs(g.distance, kDistanceStep, 1 << 20, f.distance) &&
          belongs(g.angle_first, kAngleStep, kPairAngleBins, f.angle_first) &&
          belongs(g.angle_second, kAngleStep, kPairAngleBins, f.angle_second) &&
          belongs(g.angle_normals, kAngleStep, kPairAngleBins, f.angle_normals)) {
        out.insert(static_cast<int>(i));
      }
    }
  }
  return out;
}

std::multiset<int> looked_up(const PointPairTable& table, const PointPairFeature& f) {
  std::multiset<int> out;
  for (const auto& entry : table.lookup(f.distance, pair_angle_key(f))) out.insert(entry.point);
  return out;
}

TEST(PointPairTable, HoldsEveryPairInItsCellAndInTheNextOneWhenItIsNear) {
  const PointCloud cloud = random_oriented_points(60, 2);
  const PointPairTable table(cloud, kDistanceStep);
  RandomStream random(3);
  std::size_t total = 0;
  float longest = 0;
  constexpr double kFarthest = kMaxPairLength + kDistanceStep;  // no cell goes on beyond it
  for (int k = 0; k < 600; ++k) {
    const auto angle = [&] { return static_cast<float>(random.uniform(0, M_PI)); };
    PointPairFeature f{static_cast<float>(random.uniform(0, 0.3)), angle(), angle(), angle()};
    if (k % 2 == 0) f = feature_of(cloud, static_cast<std::size_t>(random.index(60)), 7);
    const auto found = looked_up(table, f);
    if (f.distance > kFarthest) {
      EXPECT_TRUE(found.empty()) << f.distance;
      continue;
    }
    if (f.distance > kMaxPairLength) continue;
    const auto expected = expected_points(cloud, f);
    EXPECT_EQ(found, expected);
    total += expected.size();
    longest = std::max(longest, f.distance);
  }
  EXPECT_GT(total, 300u);
  EXPECT_GT(longest, 0.95 * kMaxPairLength);
}

TEST(PointPairTable, FindsThePairsOfAMovedCopy) {
  const PointCloud cloud = random_oriented_points(60, 4);
  const PointPairTable table(cloud, kDistanceStep);
  const PointCloud other = moved(cloud, random_pose(5));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      const auto f = feature_of(other, i, j);
      if (i == j || f.distance < kDistanceStep || !fixes_pose(f)) continue;
      if (f.distance > kMaxPairLength) continue;
      EXPECT_EQ(looked_up(table, f).count(static_cast<int>(i)) > 0, true) << i << ' ' << j;
    }
  }
}

TEST(PointPairTable, KnowsWhereTheSecondPointLies) {
  PointCloud cloud = random_oriented_points(2, 8);
  cloud.points[1] = cloud.points[0] + 0.05f * (cloud.points[1] - cloud.points[0]).normalized();
  const PointPairTable table(cloud, kDistanceStep);
  const auto f = feature_of(cloud, 0, 1);
  for (const auto& entry : table.lookup(f.distance, pair_angle_key(f))) {
    if (entry.point != 0) continue;
    // The line, turned back by the turn, lies along the basis' first axis.
    const Eigen::Matrix3f basis = basis_of(cloud.normals[0]);
    const Eigen::Vector3f line = basis.transpose() * (cloud.points[1] - cloud.points[0]);
    const Eigen::Vector3f back =
        Eigen::AngleAxisf(-static_cast<float>(entry.turn * 2 * M_PI / kTurnSteps),
                          Eigen::Vector3f::UnitZ()) *
        line;
    EXPECT_NEAR(std::atan2(back.y(), back.x()), 0, M_PI / kTurnSteps + 1e-3);
    return;
  }
  FAIL() << "the pair is not there";
}

TEST(PointPairTable, HasNothingBeyondItsLongestPair) {
  const PointCloud cloud = random_oriented_points(30, 6);
  const PointPairTable table(cloud, kDistanceStep);
  constexpr std::uint16_t kLastKey = PointPairTable::kAngleKeys - 1;
  for (const float distance : {table.max_distance() + 0.02f, 1.0f, 1e9f, std::nanf("")}) {
    EXPECT_TRUE(table.lookup(distance, 5).empty());
  }
  (void)table.lookup(table.max_distance(), kLastKey);  // the last cell of all
  (void)table.lookup(table.max_distance() + 0.9f * kDistanceStep, kLastKey);
}

TEST(PointPairTable, ArraysThatDoNotFitAreTold) {
  using Arrays = PointPairTable::Arrays;
  const PointCloud cloud = random_oriented_points(30, 14);
  const Arrays good = PointPairTable(cloud, kDistanceStep).arrays();
  EXPECT_TRUE(good.fit(30));
  EXPECT_FALSE(good.fit(29)) << "a point that is not there";
  EXPECT_TRUE(Arrays{}.fit(0));
  const auto with = [&good](auto change) {
    std::vector<std::uint32_t> first(good.first.begin(), good.first.end());
    std::vector<PointPairTable::Entry> entries(good.entries.begin(), good.entries.end());
    Arrays arrays = good;
    change(arrays, first, entries);
    arrays.first = std::move(first);
    arrays.entries = std::move(entries);
    return arrays.fit(30);
  };
  EXPECT_TRUE(with([](auto&, auto&, auto&) {}));
  EXPECT_FALSE(with([](auto&, auto& first, auto&) { ++first.back(); })) << "beyond the entries";
  EXPECT_FALSE(with([](auto&, auto& first, auto&) { first[first.size() / 2] = 1u << 31; }));
  EXPECT_FALSE(with([](auto&, auto& first, auto&) { first.clear(); }));
  EXPECT_FALSE(with([](auto&, auto&, auto& entries) { entries.pop_back(); }));
  EXPECT_FALSE(with([](auto&, auto&, auto& entries) { entries[0].color = kAnyColor + 1; }));
  for (const float number : {std::nanf(""), -1.0f, 1e30f, INFINITY}) {
    EXPECT_FALSE(with([number](Arrays& arrays, auto&, auto&) { arrays.inverse_step = number; }));
    EXPECT_FALSE(with([number](Arrays& arrays, auto&, auto&) { arrays.max_distance = number; }));
  }
  const PointPairTable again(good);
  const auto f = feature_of(cloud, 3, 4);
  EXPECT_EQ(looked_up(again, f), looked_up(PointPairTable(cloud, kDistanceStep), f));
}

TEST(PointPairTable, OfNothingHoldsNothing) {
  const PointPairTable table({}, 1);
  EXPECT_TRUE(table.lookup(0, 0).empty());
  EXPECT_TRUE(table.lookup(0.5f, 77).empty());
  const PointPairTable one(random_oriented_points(1, 7), kDistanceStep);
  EXPECT_TRUE(one.lookup(0.05f, 77).empty());
}

// A copy of the model somewhere else, among other points: the pose that most pairs vote for.
TEST(PairVoting, FindsTheModelAmongClutter) {
  const PointCloud model = random_oriented_points(60, 9);
  const Pose truth = random_pose(10);
  PointCloud scene = moved(model, truth);
  for (const Eigen::Vector3f& point : random_oriented_points(200, 11).points) {
    scene.points.push_back(point * 2 + truth.translation.cast<float>());
    scene.normals.push_back(point.normalized());
  }
  const PointPairTable table(model, kDistanceStep);
  std::vector<int> references(30);
  for (int r = 0; r < 30; ++r) references[static_cast<std::size_t>(r)] = 2 * r;
  for (const int threads : {1, 4}) {
    const ScenePairs pairs = scene_pairs(scene, references, 0.3f, 3, threads);
    const auto poses = vote_poses(pairs, table, 60, 1);
    ASSERT_EQ(poses.size(), references.size());
    for (const VotedPose& voted : poses) {
      EXPECT_EQ(voted.model_point, voted.reference);
      const auto i = static_cast<std::size_t>(voted.reference);
      const Eigen::Matrix3f rotation = basis_of(scene.normals[i]) *
                                       Eigen::AngleAxisf(voted.turn, Eigen::Vector3f::UnitZ()) *
                                       basis_of(model.normals[i]).transpose();
      EXPECT_LT(rotation_angle(Eigen::Quaterniond(rotation.cast<double>()), truth.rotation), 0.1);
    }
  }
}

TEST(PairVoting, PartnersAreThoseWithinReachThatFixAPose) {
  const PointCloud cloud = random_oriented_points(80, 12);
  const float reach = 0.06f;
  const ScenePairs pairs = scene_pairs(cloud, {3, 40}, reach, 3, 2);
  ASSERT_EQ(pairs.first.size(), 3u);
  for (std::size_t r = 0; r < 2; ++r) {
    std::multiset<std::pair<float, int>> expected, found;
    const auto i = static_cast<std::size_t>(pairs.references[r]);
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      const auto f = feature_of(cloud, i, j);
      if (i == j || (i + j) % 3 != 0 || f.distance > reach || !fixes_pose(f)) continue;
      expected.insert({f.distance, pair_angle_key(f)});
    }
    for (auto k = pairs.first[r]; k < pairs.first[r + 1]; ++k) {
      found.insert({pairs.partners[k].distance, pairs.partners[k].angle_key});
      if (k > pairs.first[r]) {
        EXPECT_GE(pairs.partners[k].distance, pairs.partners[k - 1].distance);
      }
    }
    EXPECT_EQ(found, expected);
  }
}

TEST(PairVoting, PointsThatAreFlaggedAloneArePartners) {
  const PointCloud cloud = random_oriented_points(80, 12);
  std::vector<std::uint8_t> partners(cloud.size());
  for (std::size_t i = 0; i < partners.size(); ++i) partners[i] = i % 2;
  const auto points_of = [](const ScenePairs& pairs) {
    std::multiset<int> points;
    for (const ScenePairs::Partner& partner : pairs.partners) points.insert(partner.point);
    return points;
  };
  std::multiset<int> odd = points_of(scene_pairs(cloud, {3, 40}, 0.06f, 5, 1));
  ASSERT_GT(std::erase_if(odd, [](int point) { return point % 2 == 0; }), 0u);
  EXPECT_FALSE(odd.empty());
  EXPECT_EQ(points_of(scene_pairs(cloud, {3, 40}, 0.06f, 5, 1, partners)), odd);
}

// Every other point of model and scene is blue. Where the scene's colours are those of the model,
// as many pairs vote for the right points as without colours. Where those of all partners are
// exchanged, the right pairs do not vote.
TEST(PairVoting, PairsVoteWhereTheirSecondPointsHaveOneColour) {
  const PointCloud model = random_oriented_points(60, 9);
  const std::vector<MatchColor> palette = {match_color({50, 60, 40}), match_color({50, 10, -60})};
  std::vector<std::uint8_t> indices;
  std::vector<MatchColor> colors, wrong;
  for (std::size_t i = 0; i < model.size(); ++i) {
    indices.push_back(i % 2);
    colors.push_back(palette[i % 2]);
    wrong.push_back(palette[i < 2 ? i % 2 : 1 - i % 2]);
  }
  const PointPairTable table(model, kDistanceStep, indices);
  const PointCloud scene = moved(model, random_pose(10));
  const ScenePairs pairs = scene_pairs(scene, {0, 1}, 0.3f, 2, 1);
  const auto plain = vote_poses(pairs, table, 60, 1);
  const auto right = vote_poses(pairs, table, 60, 1, {colors, colors, palette});
  ASSERT_EQ(plain.size(), 2u);
  ASSERT_EQ(right.size(), 2u);
  for (int r = 0; r < 2; ++r) {
    EXPECT_EQ(right[r].model_point, r);
    EXPECT_EQ(right[r].votes, plain[r].votes);
  }
  for (const VotedPose& pose : vote_poses(pairs, table, 60, 1, {wrong, colors, palette})) {
    EXPECT_LT(pose.votes, plain[pose.reference].votes / 2);
  }
}

// A point and so many second points in one place, all in one cell.
PointCloud one_point_and_others(int count) {
  RandomStream random(14);
  PointCloud cloud;
  cloud.points.push_back({0.05f, 0.01f, 0.02f});
  cloud.normals.push_back(Eigen::Vector3f(1, 2, 2) / 3);
  for (int i = 0; i < count; ++i) {
    cloud.points.push_back(1e-5f * random_vector(random));
    cloud.normals.push_back(Eigen::Vector3f(2, -1, 2) / 3);
  }
  return cloud;
}

TEST(PairVoting, OfThePairsOfLargeCellsSomeVote) {
  constexpr int kPartners = 12;
  const ScenePairs pairs = scene_pairs(one_point_and_others(kPartners), {0}, 0.3f, 1, 1);
  for (const auto& [entries, voting] : {std::pair{500, 12}, {600, 6}, {2000, 6}, {2100, 3}}) {
    const PointPairTable table(one_point_and_others(entries), kDistanceStep);
    const auto poses = vote_poses(pairs, table, entries + 1, 1);
    ASSERT_EQ(poses.size(), 1u);
    EXPECT_EQ(poses[0].model_point, 0);
    EXPECT_EQ(poses[0].votes, voting * entries);
  }
}

// A flat plate, 12 x 8 cm, without one corner: no turn maps it onto itself.
bool on_plate(const Eigen::Vector3f& p) {
  return std::abs(p.x()) < 0.06f && std::abs(p.y()) < 0.04f && (p.x() < 0.02f || p.y() < 0.01f);
}

PointCloud plate(float spacing, float offset) {
  PointCloud out;
  for (float x = -0.06f + offset; x < 0.06f; x += spacing) {
    for (float y = -0.04f + offset; y < 0.04f; y += spacing) {
      if (!on_plate({x, y, 0})) continue;
      out.points.emplace_back(x, y, 0.0f);
      out.normals.push_back(Eigen::Vector3f::UnitZ());
    }
  }
  return out;
}

Beside beside_plate(const Eigen::Vector3f& at, const Eigen::Vector3f&) {
  return on_plate(at) ? Beside::surface : Beside::end;
}

TEST(RimPoints, LieWhereTheSurfaceEnds) {
  PointCloud points;
  for (const float x : {0.0f, 0.03f, 0.045f, 0.057f}) points.points.emplace_back(x, -0.015f, 0.0f);
  points.normals.assign(points.points.size(), Eigen::Vector3f::UnitZ());
  const auto rims = find_rims(points, beside_plate);
  ASSERT_EQ(rims.size(), 2u) << "of those within 2 cm";
  for (const RimPoint& rim : rims) {
    EXPECT_NEAR(rim.point.x(), 0.06, 0.002);
    EXPECT_NEAR(rim.point.y(), -0.015, 0.002);
    EXPECT_GT(rim.outward.x(), 0.99f);
    EXPECT_EQ(rim.normal, Eigen::Vector3f::UnitZ());
  }
}

TEST(RimPoints, WhereDepthIsUnknownTheSurfaceEndsWhereItWasLastSeen) {
  PointCloud point;
  point.points = {{0.05f, -0.015f, 0}};
  point.normals = {Eigen::Vector3f::UnitZ()};
  const auto shadow = [](const Eigen::Vector3f& at, const Eigen::Vector3f& normal) {
    const bool beside = at.x() >= 0.06f && at.x() < 0.066f;
    return beside ? Beside::unknown : beside_plate(at, normal);
  };
  const auto rims = find_rims(point, shadow);
  ASSERT_EQ(rims.size(), 1u);
  EXPECT_NEAR(rims[0].point.x(), 0.06, 0.003);
}

TEST(RimPoints, WhatIsHiddenHasNone) {
  const auto hidden = [](const Eigen::Vector3f& at, const Eigen::Vector3f&) {
    return on_plate(at) ? Beside::surface : Beside::hidden;
  };
  EXPECT_TRUE(find_rims(plate(0.01f, 0.005f), hidden).empty());
}

TEST(PairVoting, TheRimOfAFlatFaceFixesItsPose) {
  const PointCloud model = plate(0.01f, 0.005f);
  const PointPairTable table(model, find_rims(model, beside_plate), kDistanceStep);
  const Pose truth = random_pose(13);
  const Pose back = truth.inverse();
  const PointCloud scene = moved(plate(0.011f, 0.003f), truth);
  const auto rims = find_rims(scene, [&](const Eigen::Vector3f& at, const Eigen::Vector3f&) {
    return beside_plate((back * at.cast<double>()).cast<float>(), {});
  });
  std::vector<int> references(scene.size());
  std::iota(references.begin(), references.end(), 0);
  constexpr float kReach = 0.3f;
  EXPECT_TRUE(scene_pairs(scene, references, kReach, 1, 1).partners.empty());
  const ScenePairs pairs = scene_rim_pairs(scene, rims, references, kReach, 2);
  int right = 0;
  const auto voted = vote_poses(pairs, table, static_cast<int>(model.size()), 1);
  for (const VotedPose& pose : voted) {
    const auto s = static_cast<std::size_t>(pose.reference);
    const auto m = static_cast<std::size_t>(pose.model_point);
    const Eigen::Matrix3f rotation = basis_of(scene.normals[s]) *
                                     Eigen::AngleAxisf(pose.turn, Eigen::Vector3f::UnitZ()) *
                                     basis_of(model.normals[m]).transpose();
    const Eigen::Vector3d there = truth * model.points[m].cast<double>();
    right += rotation_angle(Eigen::Quaterniond(rotation.cast<double>()), truth.rotation) < 0.2 &&
             (there - scene.points[s].cast<double>()).norm() < 0.02;
  }
  EXPECT_GT(right, 0.6 * static_cast<double>(voted.size()));
}

// A half turn maps the plate onto itself; its halves differ in colour.
TEST(PairVoting, ColoursTellPointsOfOneShapeApart) {
  const auto color_of = [](const Eigen::Vector3f& point) {
    return match_color(point.x() > 0 ? Eigen::Vector3f(50, 60, 40) : Eigen::Vector3f(50, 10, -60));
  };
  const auto colors_of = [&](const PointCloud& cloud) {
    std::vector<MatchColor> out;
    for (const Eigen::Vector3f& point : cloud.points) out.push_back(color_of(point));
    return out;
  };
  const PointCloud model = plate(0.01f, 0.005f), scene = plate(0.011f, 0.003f);
  const PointPairTable table(model, find_rims(model, beside_plate), kDistanceStep);
  std::vector<int> references(scene.size());
  std::iota(references.begin(), references.end(), 0);
  const ScenePairs pairs =
      scene_rim_pairs(scene, find_rims(scene, beside_plate), references, 0.3f, 1);
  const std::vector<MatchColor> of_scene = colors_of(scene), of_model = colors_of(model);
  const auto disagreeing = [&](const std::vector<VotedPose>& voted) {
    return std::ranges::count_if(voted, [&](const VotedPose& pose) {
      return !colors_agree(of_scene[pose.reference], of_model[pose.model_point]);
    });
  };
  const auto count = static_cast<int>(model.size());
  EXPECT_GT(disagreeing(vote_poses(pairs, table, count, 2)), 0);
  const auto voted = vote_poses(pairs, table, count, 2, {of_scene, of_model, {}});
  EXPECT_GT(voted.size(), references.size() / 2);
  EXPECT_EQ(disagreeing(voted), 0);
  const std::vector<MatchColor> green(model.size(), match_color({50, -60, 40}));
  EXPECT_TRUE(vote_poses(pairs, table, count, 2, {of_scene, green, {}}).empty());
}

}  // namespace
}  // namespace bpa::features
