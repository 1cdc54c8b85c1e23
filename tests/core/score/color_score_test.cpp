// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/color_score.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/cloud/cielab.hpp"
#include "core/score/color_check.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::score {
namespace {

const Pose kBrickTruth =
    test::kCameraFromWorld * test::standing_at(0, 0, test::kBrickHalf.z(), 0.7);

// A brick whose ends are of two colours, so that a half turn about z changes it.
class ColorScore : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    ModelSource painted = *test::brick_model();
    for (const Eigen::Vector3f& p : painted.surface.points) {
      painted.surface.colors.push_back(color_at(p.x()));
    }
    model_ = make_object_model(std::move(painted)).value();
    const auto rendered =
        test::render({test::table(test::kCameraFromWorld), test::brick_solid(kBrickTruth)},
                     test::kinect_camera());
    const SurfaceMap map = surface_map(rendered.frame, {});
    image_ = make_check_image(map);
    // The colours of the brick by the true surface, not by the model's points.
    observed_ = Image<Eigen::Vector3f>(map.width(), map.height(), Eigen::Vector3f(60, 0, 0));
    const Pose object_from_camera = kBrickTruth.inverse();
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
  static ColorAgreement compare(const Image<Eigen::Vector3f>& observed,
                                const Pose& pose = kBrickTruth) {
    return compare_colors(image_, observed, model_->index->cielab,
                          predict_surface(image_, *model_, pose));
  }
  static inline std::shared_ptr<const ObjectModel> model_;
  static inline CheckImage image_;
  static inline Image<Eigen::Vector3f> observed_;
};

TEST_F(ColorScore, QuickChecksTellAHalfTurn) {
  Image<MatchColor> colors(observed_.width, observed_.height, {});
  for (std::size_t i = 0; i < colors.size(); ++i) colors[i] = match_color(observed_[i]);
  const ModelIndex& index = *model_->index;
  const ColorCheck right = check_colors(image_, colors, index, to_fast(kBrickTruth));
  EXPECT_EQ(right.seen, 20);
  EXPECT_GE(right.agreeing, 18);  // points beside the seam have a mean colour
  EXPECT_GT(right.log_odds(), 0);
  const Pose half_turn = kBrickTruth * Pose{from_wxyz({0, 0, 0, 1})};
  const ColorCheck turned = check_colors(image_, colors, index, to_fast(half_turn));
  EXPECT_EQ(turned.seen, 20);
  EXPECT_LE(turned.agreeing, 2);
  EXPECT_LT(turned.log_odds(), -1);
  EXPECT_EQ(check_colors(image_, {}, index, to_fast(kBrickTruth)).seen, 0);
}

// CIELAB of a reflectance under lamps, by its definition: from linear light.
Eigen::Vector3f lit(const Eigen::Vector3f& light, const Eigen::Vector3f& reflectance) {
  const auto encoded = [](float linear) {
    return 255 *
           (linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f);
  };
  const Eigen::Vector3f c = light.cwiseProduct(reflectance);
  return CielabConverter()(Eigen::Vector3f(encoded(c.x()), encoded(c.y()), encoded(c.z())));
}
const Eigen::Vector3f kWhite = Eigen::Vector3f::Ones();
const Eigen::Vector3f kRed(0.6f, 0.1f, 0.08f), kBlue(0.1f, 0.15f, 0.6f);

// A brick of one colour, seen in another.
class PlainBrick : public ColorScore {
 protected:
  static ColorAgreement compare(const Image<Eigen::Vector3f>& seen, const Eigen::Vector3f& model) {
    const std::vector<Eigen::Vector3f> surface(model_->surface.size(), model);
    return compare_colors(image_, seen, surface, predict_surface(image_, *model_, kBrickTruth));
  }
  static ColorAgreement compare(const Eigen::Vector3f& seen, const Eigen::Vector3f& model) {
    return compare(Image<Eigen::Vector3f>(image_.width, image_.height, seen), model);
  }
  // `right` from 70 % of the columns that the brick covers.
  static Image<Eigen::Vector3f> two_parts(const Eigen::Vector3f& left,
                                          const Eigen::Vector3f& right) {
    Image<Eigen::Vector3f> out(image_.width, image_.height, left);
    for (int v = 0; v < out.height; ++v) {
      for (int u = first_right_column(); u < out.width; ++u) out.at(u, v) = right;
    }
    return out;
  }
  static int first_right_column() {
    const PredictedSurface predicted = predict_surface(image_, *model_, kBrickTruth);
    return predicted.u0 + predicted.depth.width * 7 / 10;
  }
  static double right_share() {
    int right = 0, all = 0;
    predict_surface(image_, *model_, kBrickTruth).for_each([&](int u, int, float, std::uint32_t) {
      right += u >= first_right_column();
      ++all;
    });
    return static_cast<double>(right) / all;
  }
};

TEST_F(ColorScore, OfItsOwnColoursIsNearZero) {
  EXPECT_GT(compare(observed_).likelihood, -0.05);
  EXPECT_LT(compare(observed_).tint, 5);
}

TEST_F(ColorScore, TellsApartWhatShapeDoesNot) {
  const Pose half_turn{rotation_from_vector({0, 0, M_PI}), Eigen::Vector3d::Zero()};
  EXPECT_LT(compare(observed_, kBrickTruth * half_turn).likelihood, -0.2);
  EXPECT_GT(compare(observed_, kBrickTruth * half_turn).tint, 30);
}

TEST_F(PlainBrick, PatternsCountByTheirColourDistance) {
  const Eigen::Vector3f grey(50, 10, 5);
  const auto with = [&](const Eigen::Vector3f& off) {
    return compare(two_parts(grey, grey + off), grey).likelihood / right_share();
  };
  EXPECT_NEAR(with({0, 0, 0}), 0, 1e-5);
  EXPECT_NEAR(with({0, 12, 0}), -1.0 / 9, 0.02);
  EXPECT_NEAR(with({0, 0, -24}), -4.0 / 9, 0.05);
  EXPECT_NEAR(with({0, 60, 60}), -1, 0.05);
}

TEST_F(PlainBrick, LampsAndShadowsDoNotMatter) {
  for (const float light : {1.0f, 0.5f, 0.2f}) {
    const Eigen::Vector3f lamp = light * kWhite;
    for (const auto& [seen, model] : {std::pair(lamp, kWhite), std::pair(kWhite, lamp)}) {
      const ColorAgreement same = compare(lit(seen, kRed), lit(model, kRed));
      EXPECT_NEAR(same.likelihood, 0, 1e-3) << light;
      EXPECT_NEAR(same.tint, 0, 1) << light;
      EXPECT_NEAR(same.exposure, std::log(seen.x() / model.x()) / 3, 1e-3) << light;
    }
    EXPECT_GT(compare(lit(lamp, kRed), lit(kWhite, kBlue)).tint, 50) << light;
  }
  const auto shaded = two_parts(lit(kWhite, kRed), lit(0.4f * kWhite, kRed));
  EXPECT_GT(compare(shaded, lit(kWhite, kRed)).likelihood, -0.1);
  EXPECT_LT(compare(shaded, lit(kWhite, kRed)).tint, 1);
}

TEST_F(ColorScore, WhiteBalanceIsTintAlone) {
  Image<Eigen::Vector3f> warmer = observed_;
  for (Eigen::Vector3f& lab : warmer.pixels) {  // X by 1.15, Z by 0.8
    const float y = (lab[0] + 16) / 116;
    lab[1] = 500 * (std::cbrt(1.15f) * (y + lab[1] / 500) - y);
    lab[2] = 200 * (y - std::cbrt(0.8f) * (y - lab[2] / 200));
  }
  EXPECT_NEAR(compare(warmer).likelihood, compare(observed_).likelihood, 0.02);
  EXPECT_NEAR(compare(warmer).tint, std::hypot(300 * std::log(1.15) / 3, 120 * std::log(0.8) / 3),
              3);
}

TEST_F(ColorScore, WithoutColourNeitherForNorAgainst) {
  const PredictedSurface predicted = predict_surface(image_, *model_, kBrickTruth);
  for (const ColorAgreement& unknown :
       {compare_colors(image_, {}, model_->index->cielab, predicted),
        compare_colors(image_, observed_, {}, predicted),
        compare(observed_, {kBrickTruth.rotation, {0, 0, -1}})}) {
    EXPECT_TRUE(std::isnan(unknown.likelihood));
    EXPECT_TRUE(std::isnan(unknown.tint));
    EXPECT_TRUE(std::isnan(unknown.exposure));
  }
  EXPECT_TRUE(test::brick_model()->index->cielab.empty());
}

}  // namespace
}  // namespace bpa::score
