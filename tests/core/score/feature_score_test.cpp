// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/feature_score.hpp"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "core/model/model_index.hpp"
#include "core/score/pose_check.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::score {
namespace {

class FpfhScore : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::l_model(); }
  static void TearDownTestSuite() { model_.reset(); }
  // The model's own features, posed: a scene without any error.
  void SetUp() override {
    const FastPose pose = to_fast(pose_);
    const PointCloud& features = model_->index->features;
    for (std::size_t i = 0; i < features.size(); ++i) {
      surface_.points.push_back(pose.rotation * features.points[i] + pose.translation);
      surface_.normals.push_back(pose.rotation * features.normals[i]);
    }
    keypoints_.resize(features.size());
    std::iota(keypoints_.begin(), keypoints_.end(), 0);
    fpfh_ = model_->index->fpfh;
  }
  double score(const Pose& pose) const {
    return fpfh_score(surface_, keypoints_, fpfh_, FeaturePlaces(*model_), pose);
  }

  static inline std::shared_ptr<const ObjectModel> model_;
  const Pose pose_{rotation_from_vector({0.4, -0.2, 0.9}), {0.1, 0, 0.8}};
  PointCloud surface_;
  std::vector<int> keypoints_;
  std::vector<features::Fpfh> fpfh_;
};

TEST_F(FpfhScore, OfTheSameFeaturesIsZero) { EXPECT_NEAR(score(pose_), 0, 1e-6); }

TEST_F(FpfhScore, FallsWithTheSquareOfTheDistance) {
  // 45 along one bin is a standard deviation.
  for (const float off : {22.5f, 45.0f, 90.0f, 135.0f, 400.0f}) {
    for (std::size_t i = 0; i < fpfh_.size(); ++i) {
      fpfh_[i] = model_->index->fpfh[i];
      fpfh_[i][i % 33] += off;
    }
    EXPECT_NEAR(score(pose_), -std::min(1.0, std::pow(static_cast<double>(off) / 135, 2)), 1e-4);
  }
}

TEST_F(FpfhScore, OtherPlacesMatchWorse) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    EXPECT_LT(score(test::disturbed(pose_, 0.02, 0.5, seed)), -0.02);
  }
}

TEST_F(FpfhScore, WithoutFeaturesOnTheModel) {
  EXPECT_EQ(score({pose_.rotation, {2, 0, 2}}), -1);
  keypoints_.clear();
  EXPECT_EQ(score(pose_), -1);
}

// By search over all features.
TEST_F(FpfhScore, PlacesAreTheNearestOnTheSameSide) {
  const FeaturePlaces places(*model_);
  const PointCloud& features = model_->index->features;
  RandomStream random(8);
  for (int k = 0; k < 500; ++k) {
    const auto i = static_cast<std::size_t>(random.index(static_cast<int>(features.size())));
    const Eigen::Vector3f off(static_cast<float>(random.normal()),
                              static_cast<float>(random.normal()),
                              static_cast<float>(random.normal()));
    const Eigen::Vector3f point = features.points[i] + 0.005f * off;
    int best = -1;
    float smallest = 0.01f * 0.01f;
    for (std::size_t j = 0; j < features.size(); ++j) {
      const float squared = (features.points[j] - point).squaredNorm();
      if (squared > smallest || features.normals[j].dot(features.normals[i]) <= 0) continue;
      smallest = squared;
      best = static_cast<int>(j);
    }
    const int found = places.nearest_to(point, features.normals[i]);
    ASSERT_EQ(found < 0, best < 0);
    if (best < 0) continue;
    ASSERT_FLOAT_EQ((features.points[static_cast<std::size_t>(found)] - point).norm(),
                    std::sqrt(smallest));
  }
}

}  // namespace
}  // namespace bpa::score
