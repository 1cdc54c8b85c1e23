// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/texture_score.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/cloud/cielab.hpp"
#include "core/model/model_index.hpp"
#include "core/score/rival_poses.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::score {
namespace {

using Colors = std::vector<std::array<std::uint8_t, 3>>;
using LogLight = Image<Eigen::Vector3f>;

const Pose kHalfTurn{rotation_from_vector({0, 0, M_PI}), Eigen::Vector3d::Zero()};

// Stripes along x that a half turn about z changes: narrow on one side, none on the other.
std::array<std::uint8_t, 3> stripes(const Eigen::Vector3f& p) {
  const bool dark = p.x() > 0 && std::fmod(p.x(), 0.02f) < 0.01f;
  if (dark) return {40, 60, 150};
  return {190, 160, 90};
}

// A model in an image that shows nothing but it, as it is at one pose.
struct Seen {
  std::shared_ptr<const ObjectModel> model;
  CheckImage image;
  LogLight colors;

  Seen(ModelSource source, const Pose& pose) : model(make_object_model(std::move(source)).value()) {
    image = {320, 240, 270, 270, 160, 120, std::vector<CheckPixel>(320 * 240), {}};
    colors = LogLight(image.width, image.height, Eigen::Vector3f::Zero());
    predicted(pose).for_each([&](int u, int v, float z, std::uint32_t point) {
      image.pixels[colors.index(u, v)].depth = z;
      colors.at(u, v) = model->index->log_light[point];
    });
  }
  PredictedSurface predicted(const Pose& pose) const {
    return predict_whole_surface(image, *model, pose);
  }
  TextureAgreement compare(const LogLight& observed, const Pose& pose) const {
    return compare_texture(image, observed, *model, predicted(pose));
  }
};

// Whether a pixel's blurred colours are the object's alone: none beside the outline is that near.
bool within(const PredictedSurface& predicted, int u, int v) {
  constexpr int kBeside[4][2] = {{2, 0}, {-2, 0}, {0, 2}, {0, -2}};
  return std::ranges::all_of(
      kBeside, [&](const auto& step) { return predicted.depth_at(u + step[0], v + step[1]) > 0; });
}

const Pose kBrickPose = test::look_at({0.1, -0.5, 0.4}, {0, 0, 0});

ModelSource painted_brick(auto&& color_of) {
  ModelSource source = *test::brick_model();
  source.symmetry = {.discrete = {kHalfTurn}, .continuous = {}};
  source.surface.colors.clear();
  for (const Eigen::Vector3f& p : source.surface.points) {
    source.surface.colors.push_back(color_of(p));
  }
  return source;
}

class TextureScore : public ::testing::Test {
 protected:
  static const Seen& brick() {
    static const Seen seen(painted_brick(stripes), kBrickPose);
    return seen;
  }
};

TEST_F(TextureScore, ThePatternSpeaksForItsPoseAndAgainstTheHalfTurn) {
  EXPECT_GT(brick().compare(brick().colors, kBrickPose).log_ratio, 0.5);
  EXPECT_LT(brick().compare(brick().colors, kBrickPose * kHalfTurn).log_ratio, -0.1);
}

TEST_F(TextureScore, LightChangesNothing) {
  const TextureAgreement before = brick().compare(brick().colors, kBrickPose);
  LogLight lit = brick().colors;
  brick().predicted(kBrickPose).for_each([&](int u, int v, float, std::uint32_t point) {
    const Eigen::Vector3f& normal = brick().model->surface.normals[point];
    lit.at(u, v) += Eigen::Vector3f(-0.3f, 0.1f, -0.2f);  // exposure and white balance
    lit.at(u, v)[0] += normal.dot(Eigen::Vector3f(0.2f, -0.1f, 0.4f));
  });
  EXPECT_NEAR(brick().compare(lit, kBrickPose).log_ratio, before.log_ratio, 0.01);
}

TEST_F(TextureScore, ColourAndDepthMayBeTwoPixelsApart) {
  const auto shifted = [&](int by) {
    LogLight out = brick().colors;
    for (int v = 0; v < out.height; ++v) {
      for (int u = 0; u + by < out.width; ++u) out.at(u, v) = brick().colors.at(u + by, v);
    }
    return brick().compare(out, kBrickPose).log_ratio;
  };
  EXPECT_NEAR(shifted(2), shifted(0), 0.15);
  EXPECT_LT(shifted(7), 0.5 * shifted(0));
}

// The same by dense least squares, with its own order of sums.
TEST_F(TextureScore, IsTheGainOfLeastSquares) {
  RandomStream random(5);
  LogLight noisy = brick().colors;
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    for (float& c : noisy[i]) c = 0.7f * c + 0.05f * static_cast<float>(random.normal());
  }
  constexpr double kSigma[3] = {0.10, 0.03, 0.06};
  double best = -INFINITY;
  for (int dv : {-2, 0, 2}) {
    for (int du : {-2, 0, 2}) {
      std::vector<Eigen::Matrix<double, 10, 1>> rows;  // 1, normal, three predicted, three observed
      const PredictedSurface predicted = brick().predicted(kBrickPose);
      predicted.for_each([&](int u, int v, float, std::uint32_t point) {
        if (u % 2 != 0 || v % 2 != 0 || !within(predicted, u, v)) return;
        Eigen::Matrix<double, 10, 1> row;
        row << 1, brick().model->surface.normals[point].cast<double>(),
            brick().model->index->log_light[point].cast<double>(),
            noisy.at(u + du, v + dv).cast<double>();
        rows.push_back(row);
      });
      const auto n = static_cast<Eigen::Index>(rows.size());
      Eigen::MatrixXd data(n, 10);
      for (Eigen::Index i = 0; i < n; ++i) data.row(i) = rows[static_cast<std::size_t>(i)];
      double sum = 0;
      for (int k = 0; k < 3; ++k) {
        const Eigen::MatrixXd light = data.leftCols(k == 0 ? 4 : 1);
        const auto residual = [&](const Eigen::VectorXd& y) {
          return Eigen::VectorXd(y - light * light.colPivHouseholderQr().solve(y));
        };
        const Eigen::VectorXd p = residual(data.col(4 + k)), o = residual(data.col(7 + k));
        const double slope = std::clamp(p.dot(o) / p.squaredNorm(), 0.4, 1.5);
        const double noise = static_cast<double>(n) * kSigma[k] * kSigma[k];
        sum += 0.5 * std::log((noise + o.squaredNorm()) / (noise + (o - slope * p).squaredNorm()));
      }
      best = std::max(best, sum);
    }
  }
  EXPECT_NEAR(brick().compare(noisy, kBrickPose).log_ratio, best, 0.01);
}

// Infrared cameras do not see what is black; colour cameras do.
TEST_F(TextureScore, APatternWithoutDepthCounts) {
  Seen dark = brick();
  const PredictedSurface predicted = brick().predicted(kBrickPose);
  predicted.for_each([&](int u, int v, float, std::uint32_t point) {
    const bool black = dark.model->surface.colors[point] == stripes({0.005f, 0, 0});
    if (black) dark.image.pixels[dark.colors.index(u, v)].depth = 0;
  });
  const TextureAgreement before = brick().compare(brick().colors, kBrickPose),
                         after = dark.compare(dark.colors, kBrickPose);
  EXPECT_DOUBLE_EQ(after.log_ratio, before.log_ratio);
  EXPECT_DOUBLE_EQ(after.total, before.total);
}

TEST_F(TextureScore, ColoursAtTheOutlineDoNotCount) {
  LogLight mixed = brick().colors;
  const PredictedSurface predicted = brick().predicted(kBrickPose);
  predicted.for_each([&](int u, int v, float, std::uint32_t) {
    if (!within(predicted, u, v)) mixed.at(u, v) = Eigen::Vector3f(1, 1, 1);
  });
  const TextureAgreement unmixed = brick().compare(brick().colors, kBrickPose);
  EXPECT_GT(brick().compare(mixed, kBrickPose).log_ratio, 0.8 * unmixed.log_ratio);
}

TEST_F(TextureScore, OneColourSaysNothingAndNoneIsNotKnown) {
  const auto grey = [](const Eigen::Vector3f&) { return std::array<std::uint8_t, 3>{90, 90, 90}; };
  const Seen plain(painted_brick(grey), kBrickPose);
  EXPECT_NEAR(plain.compare(brick().colors, kBrickPose).log_ratio, 0, 1e-6);
  EXPECT_TRUE(std::isnan(brick().compare({}, kBrickPose).log_ratio));
  ModelSource colorless = *test::brick_model();
  colorless.surface.colors.clear();
  const auto model = make_object_model(std::move(colorless)).value();
  const TextureAgreement none =
      compare_texture(brick().image, brick().colors, *model, brick().predicted(kBrickPose));
  EXPECT_TRUE(std::isnan(none.log_ratio));
  EXPECT_TRUE(std::isnan(none.total));
}

TEST_F(TextureScore, RivalsOfOneShapeAreToldApartByTheirPattern) {
  const std::vector<Pose> poses = {kBrickPose * kHalfTurn, kBrickPose};
  SceneFeatures scene;
  scene.image = brick().image;
  EXPECT_EQ(behind_best(scene, *brick().model, poses, poses.size())[0].color, 0);
  scene.log_light = brick().colors;
  const auto behind = behind_best(scene, *brick().model, poses, poses.size());
  EXPECT_GT(behind[0].depth, -5);
  EXPECT_EQ(behind[1].color, 0);
  EXPECT_LT(behind[0].color, -10);
}

Pose turned_to_pattern(const Seen& seen, const Pose& start) {
  return turn_to_pattern(seen.image, seen.colors, *seen.model, start, seen.predicted(start));
}

TEST_F(TextureScore, OfEqualShapesTheOneWithThePatternIsChosen) {
  for (const Pose& start : {kBrickPose, kBrickPose * kHalfTurn}) {
    EXPECT_LT(pose_error(turned_to_pattern(brick(), start), kBrickPose).angle, 1e-6);
  }
}

// A can of 6.6 cm with a label on a third of its side.
TEST(TurnToPattern, ACanIsTurnedToItsLabel) {
  ModelSource can;
  can.name = "can";
  can.symmetry.continuous = {{}};
  for (float height = -0.05f; height <= 0.05f; height += 0.0025f) {
    for (float angle = 0; angle < 2 * static_cast<float>(M_PI); angle += 0.075f) {
      const Eigen::Vector3f normal(std::cos(angle), std::sin(angle), 0);
      can.surface.points.push_back(0.033f * normal + Eigen::Vector3f(0, 0, height));
      can.surface.normals.push_back(normal);
      const bool label = angle > 1 && angle < 3;
      can.surface.colors.push_back(label ? std::array<std::uint8_t, 3>{200, 40, 30}
                                         : std::array<std::uint8_t, 3>{180, 180, 175});
    }
  }
  can.diameter = 0.12;
  const Pose truth = test::look_at({-0.05, 0.5, 0.2}, {0, 0, 0});
  const Seen seen(std::move(can), truth);
  for (const double angle : {0.0, 0.7, 2.0, -1.9}) {
    const Pose start = truth * Pose{rotation_from_vector({0, 0, angle}), Eigen::Vector3d::Zero()};
    const Pose found = turned_to_pattern(seen, start);
    EXPECT_LT(pose_error(found, truth).angle, 0.1) << angle;
  }
}

}  // namespace
}  // namespace bpa::score
