// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "ros/frames.hpp"

namespace bpa::ros {
namespace {

using wire::bpa_msgs::PosePrior;

PosePrior message() {
  PosePrior prior;
  prior.model = "mug";
  prior.pose.position = {0.1, 0.2, 0.7};
  prior.pose.orientation = {0, 0.8, 0, 0.6};
  prior.orientation.axes = {0, 1, 0, 0, -0.8, 0, 0.6, 0, 0, 0, 0, 1};
  prior.orientation.concentrations = {-300, -200, -100};
  prior.position_covariance = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  prior.weight = 0.5;
  return prior;
}

TEST(PriorsFromMessages, KeepEverything) {
  const auto priors = priors_from_messages({message()});
  ASSERT_TRUE(priors.ok()) << priors.status().message;
  ASSERT_EQ(priors->size(), 1u);
  const bpa::PosePrior& prior = priors->front();
  EXPECT_EQ(prior.model, "mug");
  EXPECT_EQ(prior.position->mean, Eigen::Vector3d(0.1, 0.2, 0.7));
  EXPECT_EQ(prior.position->covariance(0, 2), 3);
  EXPECT_EQ(prior.position->covariance(1, 0), 4);
  EXPECT_EQ(prior.orientation.axes.col(1), Eigen::Vector4d(-0.8, 0, 0.6, 0));
  EXPECT_EQ(prior.orientation.concentrations, Eigen::Vector3d(-300, -200, -100));
  EXPECT_EQ(prior.weight, 0.5);
}

TEST(PriorsFromMessages, ZerosAreUnknown) {
  PosePrior unknown = message();
  unknown.position_covariance = {};
  unknown.orientation.concentrations = {};
  unknown.pose.orientation = {1, 0, 0, 0};  // does not count
  unknown.weight = 0;
  const auto priors = priors_from_messages({unknown});
  ASSERT_TRUE(priors.ok()) << priors.status().message;
  EXPECT_FALSE(priors->front().position);
  EXPECT_TRUE(priors->front().orientation.concentrations.isZero(0));
  EXPECT_EQ(priors->front().weight, 0.95);
}

TEST(PriorsFromMessages, OrientationIsItsDistributionsMode) {
  PosePrior swapped = message();
  swapped.pose.orientation = {0.6, 0, 0.8, 0};  // w x y z where x y z w belongs
  const auto priors = priors_from_messages({message(), swapped});
  EXPECT_EQ(priors.status().code, StatusCode::invalid_argument);
  EXPECT_NE(priors.status().message.find("priors[1].pose.orientation"), std::string::npos);
}

}  // namespace
}  // namespace bpa::ros
