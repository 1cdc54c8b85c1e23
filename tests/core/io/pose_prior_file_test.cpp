// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/pose_prior_file.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/detect/pose_prior.hpp"
#include "core/io/file_bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

class PosePriorFile : public ::testing::Test {
 protected:
  Result<std::vector<PosePrior>> read(const std::string& text) {
    const std::string path = folder_.path() + "/priors.json";
    EXPECT_TRUE(write_file(path, text).ok());
    return read_pose_priors(path);
  }
  std::string refusal(const std::string& text) {
    const auto result = read(text);
    EXPECT_EQ(result.status().code, StatusCode::corrupt);
    return result.status().message;
  }
  test::TemporaryFolder folder_;
};

TEST_F(PosePriorFile, HasStandardDeviations) {
  const auto priors = read(R"({"priors": [{"model": "mug", "weight": 0.5,
      "pose": {"rotation_wxyz": [0.6, 0, 0.8, 0], "translation_m": [0.1, 0.2, 0.7]},
      "position_sigma_m": 0.02, "rotation_sigma_deg": 9}]})");
  ASSERT_TRUE(priors.ok()) << priors.status().message;
  ASSERT_EQ(priors->size(), 1u);
  const PosePrior& prior = (*priors)[0];
  EXPECT_TRUE(detect::validate(prior, "prior").ok());
  EXPECT_EQ(prior.model, "mug");
  EXPECT_EQ(prior.weight, 0.5);
  EXPECT_EQ(prior.position->mean, Eigen::Vector3d(0.1, 0.2, 0.7));
  EXPECT_TRUE(prior.position->covariance.isApprox(4e-4 * Eigen::Matrix3d::Identity()));
  const Bingham orientation = detect::orientation_of(prior);
  EXPECT_NEAR(std::abs(orientation.mode().dot(Eigen::Quaterniond(0.6, 0, 0.8, 0))), 1, 1e-12);
  EXPECT_NEAR(orientation.concentrations()[1], -2 / std::pow(M_PI / 20, 2), 1e-9);
}

TEST_F(PosePriorFile, HasWholeDistributions) {
  const auto priors = read(R"({"priors": [{"model": "mug",
      "pose": {"translation_m": [0, 0, 1]},
      "position_covariance_m2": [1, 2, 3, 4, 5, 6, 7, 8, 9],
      "bingham": {"axes": [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1], "concentrations": [-3, -2, -1]}},
      {"model": "bowl"}]})");
  ASSERT_TRUE(priors.ok()) << priors.status().message;
  ASSERT_EQ(priors->size(), 2u);
  EXPECT_EQ((*priors)[0].position->covariance(0, 1), 2);
  EXPECT_EQ((*priors)[0].position->covariance(2, 0), 7);
  EXPECT_EQ((*priors)[0].orientation.axes.col(0), Eigen::Vector4d(0, 1, 0, 0));
  EXPECT_EQ((*priors)[0].orientation.concentrations, Eigen::Vector3d(-3, -2, -1));
  EXPECT_EQ((*priors)[0].weight, 0.95);
  EXPECT_FALSE((*priors)[1].position);
  EXPECT_TRUE((*priors)[1].orientation.concentrations.isZero(0));
}

TEST_F(PosePriorFile, SaysWhatIsWrong) {
  EXPECT_NE(refusal("{").find("truncated or not JSON"), std::string::npos);
  EXPECT_NE(refusal("{}").find("priors"), std::string::npos);
  EXPECT_NE(refusal(R"({"priors": [{"model": "a"}, {}]})").find("priors[1]"), std::string::npos);
  EXPECT_NE(refusal(R"({"priors": [{"model": "a", "sigma": 1}]})").find("unknown field \"sigma\""),
            std::string::npos);
  EXPECT_NE(refusal(R"({"priors": [{"model": "a", "position_sigma_m": 1}]})").find("pose"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"priors": [{"model": "a", "rotation_sigma_deg": 1, "bingham": 2}]})")
                .find("not both"),
            std::string::npos);
  EXPECT_EQ(read_pose_priors(folder_.path() + "/none.json").status().code, StatusCode::not_found);
}

}  // namespace
}  // namespace bpa::io
