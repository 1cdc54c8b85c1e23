// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/figure_ground.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/cloud/cielab.hpp"
#include "core/observation/scene_features.hpp"
#include "core/score/rival_poses.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::score {
namespace {

const Eigen::Vector3f kRed(40, 50, 35), kGreen(55, -30, 30);  // CIELAB

std::array<std::uint8_t, 3> red(const Eigen::Vector3f&) { return {170, 50, 45}; }

// A red L before a green wall, which depth cannot tell from it: nothing has depth but the foot.
class FigureGround : public ::testing::Test {
 protected:
  void SetUp() override {
    ModelSource source = *test::l_model();
    source.surface.colors.assign(source.surface.points.size(), red({}));
    colored_ = make_object_model(std::move(source)).value();
    truth_ = test::look_at({0.1, -0.6, 0.5}, {0, 0, 0});
    scene_.image = {320, 240, 270, 270, 160, 120, std::vector<CheckPixel>(320 * 240), {}};
    scene_.sharp_light = {320, 240, log_light(kGreen)};
    const PredictedSurface seen = predict_whole_surface(scene_.image, *colored_, truth_);
    seen.for_each([&](int u, int v, float z, std::uint32_t point) {
      const std::size_t i = scene_.sharp_light.index(u, v);
      scene_.sharp_light[i] = log_light(kRed);
      if (colored_->surface.points[point].z() < 0) scene_.image.pixels[i].depth = z;
    });
  }
  Pose turned() const {
    return truth_ * Pose{rotation_from_vector(M_PI * Eigen::Vector3d::UnitZ()), {0, 0, 0}};
  }
  // How far the turned pose is behind the true one.
  double behind(const ObjectModel& model) const {
    const auto evidence = behind_best(scene_, model, std::vector<Pose>{turned(), truth_}, 2);
    EXPECT_EQ(evidence[1].color, 0);
    return evidence[0].color;
  }

  std::shared_ptr<const ObjectModel> colored_;
  Pose truth_;
  SceneFeatures scene_;
};

TEST_F(FigureGround, ColoursTellWhichPixelsAreTheObjects) {
  EXPECT_LT(behind(*colored_), -20);
  scene_.sharp_light = {};
  EXPECT_EQ(behind(*colored_), 0);
}

TEST_F(FigureGround, AModelWithoutColoursIsToldByItsOwnPixels) {
  ModelSource source = *test::l_model();
  source.surface.colors.clear();
  const auto plain = make_object_model(std::move(source)).value();
  EXPECT_LT(behind(*plain), -20);
}

TEST_F(FigureGround, OneColourEverywhereSaysNothing) {
  scene_.sharp_light = {320, 240, log_light(kRed)};
  EXPECT_NEAR(behind(*colored_), 0, 1);
}

TEST_F(FigureGround, FewExplainedPixelsAreNotEnough) {
  const PredictedSurface predicted = predict_whole_surface(scene_.image, *colored_, truth_);
  const FigureColors known(scene_.image, scene_.sharp_light, *colored_, predicted);
  EXPECT_TRUE(known.known());
  CheckImage blind = scene_.image;
  for (CheckPixel& pixel : blind.pixels) pixel.depth = 0;
  EXPECT_FALSE(FigureColors(blind, scene_.sharp_light, *colored_, predicted).known());
  EXPECT_FALSE(FigureColors(scene_.image, {}, *colored_, predicted).known());
}

}  // namespace
}  // namespace bpa::score
