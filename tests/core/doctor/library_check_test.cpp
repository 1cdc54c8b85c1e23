// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/doctor/library_check.hpp"

#include <gtest/gtest.h>

#include "core/modeling/model_source.hpp"
#include "tests/core/doctor/findings.hpp"
#include "tests/support/meshes.hpp"

namespace bpa::doctor {
namespace {

using test::Whats;
using test::whats;

using Rgb = std::array<std::uint8_t, 3>;

/// A model of one colour; black: of none.
ModelSource model(const std::string& name, const TriangleMesh& mesh, const Rgb& color = {}) {
  const auto source = modeling::model_source_from_mesh(mesh, name, 1);
  EXPECT_TRUE(source.ok()) << source.status().message;
  ModelSource out = source.ok() ? *source : ModelSource();
  out.surface.colors.clear();
  if (color != Rgb{}) out.surface.colors.assign(out.surface.size(), color);
  return out;
}

ModelSource brick(const std::string& name, const Rgb& color = {}) {
  return model(name, test::box_mesh({0.06f, 0.04f, 0.025f}), color);
}

constexpr Rgb kRed = {200, 30, 30}, kDarkRed = {190, 32, 28}, kBlue = {30, 40, 200};

TEST(CheckLookAlikes, OfOneShapeAndColour) {
  EXPECT_EQ(whats(check_look_alikes({brick("a", kRed), brick("b", kDarkRed)}, true)),
            Whats{"a and b look alike"});
}

TEST(CheckLookAlikes, ColourTellsThemApartOnlyIfAllHaveIt) {
  const std::vector<ModelSource> models = {brick("a", kRed), brick("b", kBlue)};
  EXPECT_EQ(whats(check_look_alikes(models, true)), Whats{});
  EXPECT_EQ(whats(check_look_alikes(models, false)), Whats{"a and b look alike"});
  EXPECT_EQ(whats(check_look_alikes({brick("a", kRed), brick("b")}, true)),
            Whats{"a and b look alike"});
}

TEST(CheckLookAlikes, NotOfAnotherShape) {
  // An L with the diameter of the brick.
  TriangleMesh l = test::l_mesh();
  const ModelSource other = model("b", l);
  const auto scale = static_cast<float>(brick("a").diameter / other.diameter);
  for (Eigen::Vector3f& vertex : l.vertices) vertex *= scale;
  EXPECT_NEAR(model("b", l).diameter, brick("a").diameter, 0.003);
  EXPECT_EQ(whats(check_look_alikes({brick("a"), model("b", l)}, false)), Whats{});
}

/// A wall at a distance.
Frame wall(float z, bool with_color = false) {
  Frame frame;
  frame.camera = {640, 480, 525, 525, 319.5, 239.5};
  frame.depth.assign(640 * 480, z);
  if (with_color) frame.color.assign(3 * frame.depth.size(), 100);
  return frame;
}

TEST(CheckModelsInFrame, SaysNothingOfModelsThatFit) {
  EXPECT_EQ(whats(check_models_in_frame({brick("a"), brick("b", kRed)}, wall(0.8f), {})), Whats{});
  EXPECT_EQ(whats(check_models_in_frame({brick("b", kRed)}, wall(0.8f, true), {})), Whats{});
}

// A cube of side s covers 1.5 s^2 on average, here at f = 262.5 pixels of the searched image.
TEST(CheckModelsInFrame, ModelsTooSmall) {
  const ModelSource cube = model("cube", test::box_mesh({0.0125f, 0.0125f, 0.0125f}));
  const double pixels_at_1_m = 1.5 * 0.025 * 0.025 * 262.5 * 262.5;
  ASSERT_NEAR(pixels_at_1_m, 64.6, 0.1);
  EXPECT_EQ(whats(check_models_in_frame({cube}, wall(0.95f), {})), Whats{});
  EXPECT_EQ(whats(check_models_in_frame({cube}, wall(1.1f), {})),
            Whats{"models are too small for the distance"});
}

// The view is 640 / 525 as wide as it is far.
TEST(CheckModelsInFrame, ModelsLargerThanTheView) {
  const ModelSource plank = model("plank", test::box_mesh({0.5f, 0.05f, 0.05f}));
  EXPECT_EQ(whats(check_models_in_frame({plank}, wall(0.9f), {})), Whats{});
  EXPECT_EQ(whats(check_models_in_frame({plank}, wall(0.7f), {})),
            Whats{"models are larger than the view"});
}

TEST(CheckModelsInFrame, ModelsWithoutColour) {
  EXPECT_EQ(whats(check_models_in_frame({brick("a")}, wall(0.8f, true), {})),
            Whats{"models have no colour, but the frame has"});
}

}  // namespace
}  // namespace bpa::doctor
