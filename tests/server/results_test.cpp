// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/convert/results.hpp"

#include <gtest/gtest.h>

#include "core/geometry/pose.hpp"
#include "idl/wire/time.hpp"

namespace bpa::server {
namespace {

Placement placement(const std::string& model, int number, double probability) {
  Placement p;
  p.model = model;
  p.model_number = number;
  p.presence = probability;
  p.probability = 0.5 * probability;
  p.frame_from_object.translation = {0.1, 0.2, 0.9};
  p.frame_from_object.rotation = rotation_from_vector({0, 0, 1.5707963267948966});
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) p.covariance(i, j) = 10 * i + j;
  }
  p.orientation.axes.col(2) = Eigen::Vector4d(0.5, 0.5, 0.5, 0.5);
  p.orientation.concentrations = {-30, -20, -10};
  p.components = {{"range", -1.5}};
  p.alternatives = {{p.frame_from_object, 0.25}};
  return p;
}

SceneInterpretations scene() {
  SceneInterpretations scene;
  scene.stamp_ns = 3'000'000'007;
  scene.frame_id = "cam";
  scene.timings = {{"cloud", 12.5}};
  scene.total_milliseconds = 20;
  Interpretation best;
  best.probability = 0.75;
  best.placements = {placement("mug", 3, 0.9), placement("mug", 3, 0.8), placement("box", 5, 0.7)};
  Interpretation second;
  second.rank = 2;
  second.probability = 0.25;
  scene.interpretations = {best, second};
  scene.fused_frames = 4;
  return scene;
}

Models models() {
  auto mug = std::make_shared<ObjectModel>();
  mug->name = "mug";
  mug->number = 3;
  mug->diameter = 0.15;
  mug->surface.points = {{0, 0, 0}, {0.1f, 0.02f, 0.04f}};
  mug->symmetry.continuous.resize(1);
  return {mug};
}

TEST(Results, InterpretationsKeepEveryField) {
  const auto message = interpretations_message(scene(), {3'000'000'007, "cam", 18, 7});
  EXPECT_EQ(message.header.frame_id, "cam");
  EXPECT_EQ(to_ns(message.header.stamp), 3'000'000'007);
  EXPECT_EQ(message.models_searched, 18U);
  EXPECT_EQ(message.seed, 7U);
  EXPECT_EQ(message.fused_frames, 4U);
  EXPECT_EQ(message.stage_timings.at(0).name, "cloud");
  ASSERT_EQ(message.interpretations.size(), 2U);
  EXPECT_EQ(message.interpretations[1].probability, 0.25);
  const auto& placements = message.interpretations[0].placements;
  ASSERT_EQ(placements.size(), 3U);
  EXPECT_EQ(placements[0].instance, 0U);
  EXPECT_EQ(placements[1].instance, 1U);
  EXPECT_EQ(placements[2].instance, 0U);
  const auto& first = placements[0];
  EXPECT_EQ(first.pose.covariance[6 * 2 + 5], 25);
  EXPECT_NEAR(first.pose.pose.orientation.z, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(first.pose.pose.orientation.w, std::sqrt(0.5), 1e-12);
  EXPECT_EQ(first.orientation.axes[8], 0.5);
  EXPECT_EQ(first.orientation.concentrations[0], -30);
  EXPECT_EQ(first.score_components.at(0).value, -1.5);
  EXPECT_EQ(first.alternatives.at(0).weight, 0.25);
}

TEST(Results, AdviceIsBesideAnAnswer) {
  const auto message = interpretations_message(SceneInterpretations(), {5, "cam", 1, 0, "too far"});
  EXPECT_EQ(message.status.code, 0);
  EXPECT_EQ(message.status.message, "too far");
}

TEST(Results, AFailureCarriesItsReason) {
  const auto message = interpretations_message(invalid_argument("fx is 0"), {5, "cam", 0, 0});
  EXPECT_EQ(message.status.code, 1);
  EXPECT_EQ(message.status.message, "fx is 0");
  EXPECT_TRUE(message.interpretations.empty());
  EXPECT_EQ(to_ns(message.header.stamp), 5);
}

TEST(Results, DetectionsHoldTheBestInterpretation) {
  const auto message = detections_message(scene(), models());
  ASSERT_EQ(message.detections.size(), 3U);
  const auto& mug = message.detections[1];
  EXPECT_EQ(mug.id, "mug_1");
  EXPECT_EQ(mug.header.frame_id, "cam");
  ASSERT_EQ(mug.results.size(), 1U);
  EXPECT_EQ(mug.results[0].hypothesis.class_id, "mug");
  EXPECT_EQ(mug.results[0].hypothesis.score, 0.8);
  EXPECT_EQ(mug.results[0].pose.covariance[1], 1);
  EXPECT_NEAR(mug.bbox.size.x, 0.1, 1e-6);
  // The box's centre (0.05, 0.01, 0.02), turned by 90 degrees about z, then moved.
  EXPECT_NEAR(mug.bbox.center.position.x, 0.1 - 0.01, 1e-6);
  EXPECT_NEAR(mug.bbox.center.position.y, 0.2 + 0.05, 1e-6);
  EXPECT_NEAR(mug.bbox.center.position.z, 0.9 + 0.02, 1e-6);
}

TEST(Results, NothingFoundIsEmptyNotMissing) {
  SceneInterpretations nothing;
  nothing.frame_id = "cam";
  EXPECT_TRUE(detections_message(nothing, {}).detections.empty());
  EXPECT_TRUE(transforms_message(nothing, "bpa").transforms.empty());
  const auto markers = markers_message(nothing, {}, 0);
  ASSERT_EQ(markers.markers.size(), 1U);  // clears those of the last frame
  EXPECT_EQ(markers.markers[0].action, wire::visualization_msgs::Marker::kDeleteall);
}

TEST(Results, MarkersAndTransformsNameEveryInstance) {
  const auto markers = markers_message(scene(), models(), 1.5);
  EXPECT_EQ(markers.markers.size(), 1U + 2 * 3U);
  EXPECT_EQ(markers.markers[4].text, "mug_1 80 %");
  EXPECT_EQ(markers.markers[4].lifetime.sec, 1);
  EXPECT_EQ(markers.markers[4].lifetime.nanosec, 500'000'000U);
  const auto transforms = transforms_message(scene(), "bpa");
  ASSERT_EQ(transforms.transforms.size(), 3U);
  EXPECT_EQ(transforms.transforms[1].child_frame_id, "bpa/mug_1");
  EXPECT_EQ(transforms.transforms[1].header.frame_id, "cam");
}

TEST(Results, ModelInfoHasBoxAndSymmetry) {
  const auto message = model_message(*models().front());
  EXPECT_EQ(message.name, "mug");
  EXPECT_EQ(message.number, 3U);
  EXPECT_FLOAT_EQ(static_cast<float>(message.box_max.x), 0.1f);
  EXPECT_EQ(message.point_count, 2U);
  EXPECT_EQ(message.continuous_symmetries.size(), 1U);
}

}  // namespace
}  // namespace bpa::server
