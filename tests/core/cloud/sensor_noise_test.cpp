// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/sensor_noise.hpp"

#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/cloud/surface_map.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/pcd_file.hpp"
#include "core/sim/scenes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa {
namespace {

// The published curves, written out anew.
TEST(SensorNoise, IsAsPublished) {
  for (const float z : {0.5f, 0.8f, 1.2f, 2.0f, 3.0f}) {
    EXPECT_NEAR(noise_of(SensorKind::structured_light)(z), 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4),
                1e-7);
    EXPECT_NEAR(noise_of(SensorKind::active_stereo)(z),
                1e-3 / std::sqrt(12.0) + z * z * 0.08 / (924 * 0.055), 6e-5);
  }
}

std::string text_of(const SensorTraits& t) {
  return "noise " + std::to_string(1e3 * t.noise) + " mm, whiteness " + std::to_string(t.whiteness);
}

TEST(SensorTraits, NaNIsNoDepth) {
  Frame zeros;
  zeros.camera = {160, 120, 200, 200, 79.5, 59.5};
  RandomStream random(1);
  for (int i = 0; i < 160 * 120; ++i) {
    const double depth = i % 200 == 0 ? 0 : 1e-3 * std::round(1000 + 3 * random.normal());
    zeros.depth.push_back(static_cast<float>(depth));
  }
  Frame nans = zeros;
  for (float& depth : nans.depth) depth = depth > 0 ? depth : std::nanf("");
  const SensorTraits expected = sensor_traits(zeros), traits = sensor_traits(nans);
  EXPECT_TRUE(traits.measured);
  EXPECT_NEAR(expected.noise, 0.003, 3e-4);
  EXPECT_EQ(traits.noise, expected.noise);
  EXPECT_EQ(traits.whiteness, expected.whiteness);
}

class KindOfFrame : public testing::TestWithParam<SensorKind> {};

TEST_P(KindOfFrame, IsToldFromTheFrame) {
  static const sim::Stage stage(sim::household_objects({"mug", "can", "cereal_box", "bowl"}));
  sim::SceneOptions options;
  options.min_objects = 2;
  options.max_objects = 4;
  options.max_distractors = 0;
  options.min_distance = 0.8;  // nearer, a stereo camera's noise is lost in whole millimetres
  options.sensor.kind = GetParam();
  for (int k = 0; k < 10; ++k) {
    const sim::SimulatedScene scene = simulate_scene(stage, options, sim::scene_seed(11, k));
    const SensorTraits traits = sensor_traits(scene.frames[0].frame);
    EXPECT_EQ(name_of(sensor_kind_of(traits)), name_of(GetParam())) << k << ": " << text_of(traits);
    Frame ideal = scene.frames[0].frame;
    ideal.depth = scene.frames[0].ideal_depth;
    EXPECT_FALSE(sensor_traits(ideal).measured);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, KindOfFrame, testing::ValuesIn(kSensorKinds),
                         [](const auto& p) { return std::string(name_of(p.param)); });

TEST(KindOfRealFrame, IsStructuredLight) {
  const std::string data = test::real_data();
  if (data.empty()) GTEST_SKIP() << "no real frames here; BPA_DATA names their folder";
  std::vector<Frame> frames;
  const auto entries = io::read_bop_frames(data + "/ycbv", "test");
  ASSERT_TRUE(entries.ok());
  for (const io::BopFrame& entry : *entries) frames.push_back(*io::load_bop_frame(entry));
  for (const auto& file : std::filesystem::directory_iterator(data + "/osd_clutter")) {
    if (file.path().extension() != ".pcd") continue;
    const auto cloud = io::read_pcd(file.path());
    ASSERT_TRUE(cloud.ok());
    const auto frame = io::frame_from_organised_cloud(*cloud);
    if (frame.ok()) frames.push_back(frame->frame);
  }
  EXPECT_GE(frames.size(), 15U);
  for (const Frame& frame : frames) {
    const SensorTraits traits = sensor_traits(frame);
    EXPECT_EQ(name_of(sensor_kind_of(traits)), "structured_light") << text_of(traits);
  }
}

TEST(SurfaceMapNoise, IsThatOfTheSetting) {
  Frame frame;
  frame.camera = {64, 48, 60, 60, 31.5, 23.5};
  frame.depth.assign(64 * 48, 1.0f);
  for (const SensorKind kind : kSensorKinds) {
    SurfaceMapOptions options;
    options.sensor = name_of(kind);
    ASSERT_TRUE(validate(options).ok());
    const SurfaceMap map = surface_map(frame, options);
    EXPECT_EQ(map.sensor, kind);
    EXPECT_EQ(map.noise(1.0f), noise_of(kind)(1.0f));
  }
  SurfaceMapOptions options;
  EXPECT_EQ(surface_map(frame, options).sensor, SensorKind::structured_light);
  options.sensor = "radar";
  EXPECT_TRUE(validate(options).message.starts_with(
      "sensor is \"radar\"; it must be one of auto, structured_light, active_stereo, "
      "time_of_flight"));
}

}  // namespace
}  // namespace bpa
