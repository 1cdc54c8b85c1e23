// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>

#include <gtest/gtest.h>

#include "core/scene/overlaps.hpp"

namespace bpa::scene {
namespace {

std::shared_ptr<const ObjectModel> model(int number) {
  auto out = std::make_shared<ObjectModel>();
  out->name = "object" + std::to_string(number);
  out->number = number;
  out->diameter = 0.1;
  return out;
}

const std::shared_ptr<const ObjectModel> kMug = model(1), kBox = model(2);

// Turned by `degrees` about its own place.
detect::Candidate turned(const std::shared_ptr<const ObjectModel>& which, double degrees,
                         double odds) {
  detect::Candidate out;
  out.model = which.get();
  out.refinement.frame_from_object = {
      Eigen::Quaterniond(Eigen::AngleAxisd(degrees * M_PI / 180, Eigen::Vector3d::UnitZ())),
      {0, 0, 1}};
  out.score = std::log(odds);
  out.explained = {1, 2, 3};
  return out;
}

std::vector<PoseAlternative> alternatives(const std::vector<detect::Candidate>& candidates,
                                          std::size_t chosen) {
  return alternatives_of(candidates, competition_of(candidates, find_overlaps(candidates, -8)),
                         chosen);
}

TEST(Alternatives, AreTheSameModelsOtherPosesByWeight) {
  // 0 and 4 degrees are one pose; so are 90 and 95.
  const std::vector<detect::Candidate> all{turned(kMug, 0, 4),   turned(kMug, 4, 1),
                                           turned(kMug, 90, 2),  turned(kMug, 95, 1),
                                           turned(kMug, 180, 2), turned(kBox, 0, 50)};
  const auto found = alternatives(all, 0);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].weight, 0.3, 1e-9);
  EXPECT_NEAR(pose_error(found[0].frame_from_object, all[2].pose()).angle, 0, 1e-9);
  EXPECT_NEAR(found[1].weight, 0.2, 1e-9);
  EXPECT_NEAR(pose_error(found[1].frame_from_object, all[4].pose()).angle, 0, 1e-9);
}

TEST(Alternatives, AreNoneWhereTheViewDecides) {
  EXPECT_TRUE(alternatives({turned(kMug, 0, 4)}, 0).empty());
  EXPECT_TRUE(alternatives({turned(kMug, 0, 4), turned(kBox, 90, 4)}, 0).empty());
  EXPECT_TRUE(alternatives({turned(kMug, 0, 1000), turned(kMug, 90, 1)}, 0).empty());
}

TEST(Alternatives, WeightsSumToOneWithTheChosenOne) {
  const std::vector<detect::Candidate> all{turned(kMug, 0, 1), turned(kMug, 60, 6),
                                           turned(kMug, 120, 3), turned(kMug, 240, 0.01)};
  const auto found = alternatives(all, 0);
  ASSERT_EQ(found.size(), 2u) << "what weighs next to nothing is left out";
  EXPECT_NEAR(found[0].weight, 0.6, 1e-9);
  EXPECT_NEAR(found[1].weight, 0.3, 1e-9);
}

TEST(Alternatives, ElsewhereIsAnotherObject) {
  detect::Candidate other = turned(kMug, 90, 4);
  other.refinement.frame_from_object.translation.x() = 0.5;
  other.explained = {7, 8, 9};
  EXPECT_TRUE(alternatives({turned(kMug, 0, 4), other}, 0).empty());
}

}  // namespace
}  // namespace bpa::scene
