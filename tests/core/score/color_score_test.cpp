// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/color_score.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/cloud/cielab.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa {
namespace {

const Pose kCameraFromWorld = test::look_at({0.1, -0.6, 0.5}, {0, 0, 0});
const Pose kTruth = kCameraFromWorld * test::standing_at(0, 0, test::kBrickHalf.z(), 0.7);

// A brick whose ends are of two colours, so that a half turn about z changes it.
class ColorScore : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    ModelSource painted = *test::brick_model();
    for (const Eigen::Vector3f& p : painted.surface.points) {
      painted.surface.colors.push_back(color_at(p.x()));
    }
    model_ = make_object_model(std::move(painted)).value();
    const auto rendered = test::render({test::table(kCameraFromWorld), test::brick_solid(kTruth)},
                                       test::kinect_camera());
    const SurfaceMap map = surface_map(rendered.frame, {});
    image_ = make_check_image(map);
    // The colours of the brick by the true surface, not by the model's points.
    observed_ = Image<Eigen::Vector3f>(map.width(), map.height(), Eigen::Vector3f(60, 0, 0));
    const Pose object_from_camera = kTruth.inverse();
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (rendered.solid[rendered.index_of(map, i)] != 1) continue;
      const auto [r, g, b] =
          color_at(static_cast<float>((object_from_camera * map.points[i].cast<double>()).x()));
      observed_[i] = CielabConverter()(Eigen::Vector3f(r, g, b));
    }
  }
  static void TearDownTestSuite() { model_.reset(); }
  static std::array<std::uint8_t, 3> color_at(float x) {
    if (x > 0) return {200, 60, 50};
    return {40, 90, 180};
  }
  static double score(const Image<Eigen::Vector3f>& observed, const Pose& pose = kTruth) {
    return color_score(image_, observed, model_->index->cielab,
                       predict_surface(image_, *model_, pose));
  }
  static Image<Eigen::Vector3f> shifted(const Eigen::Vector3f& by) {
    Image<Eigen::Vector3f> out = observed_;
    for (Eigen::Vector3f& lab : out.pixels) lab += by;
    return out;
  }

  static inline std::shared_ptr<const ObjectModel> model_;
  static inline CheckImage image_;
  static inline Image<Eigen::Vector3f> observed_;
};

TEST_F(ColorScore, OfItsOwnColoursIsNearZero) { EXPECT_GT(score(observed_), -0.05); }

TEST_F(ColorScore, TellsApartWhatShapeDoesNot) {
  const Pose half_turn{rotation_from_vector({0, 0, M_PI}), Eigen::Vector3d::Zero()};
  EXPECT_LT(score(observed_, kTruth * half_turn), -0.9);
}

TEST_F(ColorScore, FallsWithTheColourDistance) {
  const Image<Eigen::Vector3f> flat(image_.width, image_.height, Eigen::Vector3f(50, 10, 5));
  const auto with = [&](const Eigen::Vector3f& off) {
    const std::vector<Eigen::Vector3f> surface(model_->surface.size(),
                                               Eigen::Vector3f(50, 10, 5) + off);
    return color_score(image_, flat, surface, predict_surface(image_, *model_, kTruth));
  };
  EXPECT_NEAR(with({0, 0, 0}), 0, 1e-6);
  EXPECT_NEAR(with({0, 12, 0}), -1.0 / 9, 1e-4);
  EXPECT_NEAR(with({0, 0, -24}), -4.0 / 9, 1e-4);
  EXPECT_NEAR(with({0, 60, 60}), -1, 1e-6);
}

// The same surface under other light, by the definition of CIELAB: converted from linear light.
TEST_F(ColorScore, LampsAndShadowsDoNotMatter) {
  const auto lit = [](float light, const Eigen::Vector3f& reflectance) {
    const auto encoded = [](float linear) {
      return 255 * (linear <= 0.0031308f ? 12.92f * linear
                                         : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f);
    };
    const Eigen::Vector3f c = light * reflectance;
    return CielabConverter()(Eigen::Vector3f(encoded(c.x()), encoded(c.y()), encoded(c.z())));
  };
  const Eigen::Vector3f red(0.6f, 0.1f, 0.08f), blue(0.1f, 0.15f, 0.6f);
  const PredictedSurface predicted = predict_surface(image_, *model_, kTruth);
  const auto with = [&](const Eigen::Vector3f& seen, const Eigen::Vector3f& expected) {
    const Image<Eigen::Vector3f> flat(image_.width, image_.height, seen);
    const std::vector<Eigen::Vector3f> surface(model_->surface.size(), expected);
    return color_score(image_, flat, surface, predicted);
  };
  for (float light : {1.0f, 0.5f, 0.2f}) {
    EXPECT_NEAR(with(lit(light, red), lit(1, red)), 0, 1e-3) << light;
    EXPECT_NEAR(with(lit(1, red), lit(light, red)), 0, 1e-3) << light;
    EXPECT_LT(with(lit(light, red), lit(1, blue)), -0.9) << light;
  }
  // Half of it in the shade.
  Image<Eigen::Vector3f> half(image_.width, image_.height, lit(1, red));
  for (int v = 0; v < half.height; ++v) {
    for (int u = 0; u < predicted.u0 + predicted.depth.width / 2; ++u)
      half.at(u, v) = lit(0.4f, red);
  }
  const std::vector<Eigen::Vector3f> surface(model_->surface.size(), lit(1, red));
  EXPECT_GT(color_score(image_, half, surface, predicted), -0.2);
  EXPECT_LT(score(shifted({0, 20, 0})), score(observed_) - 0.2);
}

TEST_F(ColorScore, WithoutColourNeitherForNorAgainst) {
  const PredictedSurface predicted = predict_surface(image_, *model_, kTruth);
  EXPECT_TRUE(std::isnan(color_score(image_, {}, model_->index->cielab, predicted)));
  EXPECT_TRUE(std::isnan(color_score(image_, observed_, {}, predicted)));
  EXPECT_TRUE(std::isnan(score(observed_, {kTruth.rotation, {0, 0, -1}})));
  EXPECT_TRUE(test::brick_model()->index->cielab.empty());
}

}  // namespace
}  // namespace bpa
