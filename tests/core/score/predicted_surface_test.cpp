// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/predicted_surface.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/score/likelihood.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::score {
namespace {

// Against exact rays.
TEST(PredictedSurface, IsWhatACameraWouldSee) {
  const auto model = test::l_model();
  for (const Pose& pose : {test::kTruth, test::disturbed(test::kTruth, 0.05, 1.0, 3),
                           test::disturbed(test::kTruth, 0.05, 2.0, 4)}) {
    const auto rendered = test::render(test::l_solids(pose), test::kinect_camera(320));
    SurfaceMap map = surface_map(rendered.frame, {});
    const CheckImage image = make_check_image(map);
    ASSERT_EQ(image.width, 320);
    for (const auto& predict : {predict_surface, predict_whole_surface}) {
      const PredictedSurface predicted = predict(image, *model, pose);
      int both = 0, either = 0, right = 0;
      for (int v = 0; v < image.height; ++v) {
        for (int u = 0; u < image.width; ++u) {
          const float truth = rendered.frame.depth[static_cast<std::size_t>(v * 320 + u)];
          const float depth = predicted.depth_at(u, v);
          both += truth > 0 && depth > 0;
          either += truth > 0 || depth > 0;
          right += truth > 0 && depth > 0 && std::abs(truth - depth) < 0.004f;
        }
      }
      EXPECT_GT(both, 1000);
      EXPECT_GT(both, 0.9 * either);
      EXPECT_GT(right, 0.95 * both);
    }
  }
}

TEST(PredictedSurface, NamesThePointThatIsSeen) {
  const auto model = test::l_model();
  const CheckImage image = make_check_image(surface_map(
      test::render({test::table(test::kCameraFromWorld)}, test::kinect_camera()).frame, {}));
  const FastPose pose = to_fast(test::kTruth);
  int covered = 0;
  predict_surface(image, *model, test::kTruth)
      .for_each([&](int u, int v, float z, std::uint32_t i) {
        const Eigen::Vector3f p = pose.rotation * model->surface.points[i] + pose.translation;
        ASSERT_NEAR(p.z(), z, 0.01);
        ASSERT_NEAR(image.fx * p.x() / p.z() + image.cx, u, 1.0);
        ASSERT_NEAR(image.fy * p.y() / p.z() + image.cy, v, 1.0);
        ++covered;
      });
  EXPECT_GT(covered, 1000);
}

TEST(PredictedSurface, OutOfSightIsEmpty) {
  const auto model = test::l_model();
  const CheckImage image = make_check_image(surface_map(
      test::render({test::table(test::kCameraFromWorld)}, test::kinect_camera()).frame, {}));
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(9, 0, 1),
                                       Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, -3, 1)}) {
    const PredictedSurface out = predict_surface(image, *model, {test::kTruth.rotation, place});
    int covered = 0;
    out.for_each([&](int, int, float, std::uint32_t) { ++covered; });
    EXPECT_EQ(covered, 0) << place.transpose();
    EXPECT_EQ(out.depth_at(3, 3), 0);
  }
}

TEST(PixelOf, IsTheCamerasProjection) {
  CheckImage image;
  image.width = 320, image.height = 240;
  image.fx = image.fy = 262.5f, image.cx = 159.5f, image.cy = 119.5f;
  const Camera camera{320, 240, 262.5, 262.5, 159.5, 119.5};
  for (const auto& [u, v] : {std::pair(0, 0), {319, 239}, {17, 200}}) {
    const Eigen::Vector3f point = camera.unproject(u + 0.4, v - 0.4, 1.3).cast<float>();
    EXPECT_EQ(image.pixel_of(point), 320 * v + u);
    EXPECT_LT((image.project(point) - Eigen::Vector2f(u + 0.4f, v - 0.4f)).norm(), 1e-4f);
  }
  EXPECT_EQ(image.pixel_of(camera.unproject(-0.6, 5, 1).cast<float>()), -1);
  EXPECT_EQ(image.pixel_of(camera.unproject(319.6, 5, 1).cast<float>()), -1);
  EXPECT_EQ(image.pixel_of({0, 0, -1}), -1);
  EXPECT_EQ(image.pixel_of({0, 0, std::nanf("")}), -1);
}

TEST(Likelihood, KnownValues) {
  EXPECT_EQ(truncated_log_normal(0, 2), 0);
  EXPECT_NEAR(truncated_log_normal(2, 2), -1.0 / 9, 1e-12);
  EXPECT_EQ(truncated_log_normal(-60, 2), -1);
  EXPECT_EQ(truncated_log(1, 0.01), 0);
  EXPECT_NEAR(truncated_log(0.1, 0.01), -0.5, 1e-12);
  EXPECT_EQ(truncated_log(0, 0.01), -1);
  EXPECT_EQ(visibility_probability(1.0, 0.9), 1);
  EXPECT_EQ(visibility_probability(0.0, 0.9), 1);
  EXPECT_NEAR(visibility_probability(1.0, 1.01), std::exp(-0.5), 1e-9);
  EXPECT_LT(visibility_probability(1.0, 1.1), 1e-9);
}

}  // namespace
}  // namespace bpa::score
