// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Objects that only their print tells apart.
#include <cmath>

#include <gtest/gtest.h>

#include "core/pipeline/detector.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa {
namespace {

using Rgb = std::array<std::uint8_t, 3>;
using Print = Rgb (*)(const Eigen::Vector3f& point);

// Both have the same two colours in equal shares. A half turn about z or y changes each, one about
// x neither.
Rgb ink(bool dark) { return dark ? Rgb{60, 70, 120} : Rgb{200, 190, 150}; }
Rgb wide(const Eigen::Vector3f& p) { return ink(p.x() > 0); }
Rgb narrow(const Eigen::Vector3f& p) {
  return ink(std::fmod(p.x() + 0.1f + 0.2f * (p.x() + 0.1f), 0.04f) < 0.02f);
}

constexpr float kFloor[3] = {110, 105, 100};

std::shared_ptr<const ObjectModel> printed_brick(const char* name, int number, Print print) {
  ModelSource source = *test::brick_model();
  source.name = name;
  source.number = number;
  for (const Eigen::Vector3f& p : source.surface.points) source.surface.colors.push_back(print(p));
  return make_object_model(std::move(source)).value();
}

// A printed brick on a table, under light that is half as bright and bluer than the model's.
Frame picture(const Pose& camera_from_world, const Pose& camera_from_brick, Print print) {
  auto seen = test::render({test::table(camera_from_world), test::brick_solid(camera_from_brick)},
                           test::kinect_camera(), 1, 8);
  Frame& frame = seen.frame;
  const Pose brick_from_camera = camera_from_brick.inverse();
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    const double u = static_cast<double>(i % static_cast<std::size_t>(frame.camera.width));
    const double v = static_cast<double>(i / static_cast<std::size_t>(frame.camera.width));
    const Eigen::Vector3d point = frame.camera.unproject(u, v, double{frame.depth[i]});
    const Rgb color = print((brick_from_camera * point).cast<float>());
    for (int c = 0; c < 3; ++c) {
      const float value = seen.solid[i] == 1 ? (c == 2 ? 0.8f : 0.6f) * color[c] : kFloor[c];
      frame.color.push_back(static_cast<std::uint8_t>(value));
    }
  }
  return frame;
}

TEST(Patterns, TellObjectsOfOneShapeApartAndWhichWayRoundTheyAre) {
  auto library = std::make_shared<ModelLibrary>();
  ASSERT_TRUE(library->add(printed_brick("wide", 1, wide)).ok());
  ASSERT_TRUE(library->add(printed_brick("narrow", 2, narrow)).ok());
  DetectorOptions options;
  options.detect.refine.max_refined = 10;
  const Detector detector(library, options);
  const SymmetryGroup about_x{{{Eigen::Quaterniond(0, 1, 0, 0), Eigen::Vector3d::Zero()}}, {}};
  const Pose camera_from_world = test::look_at({0.1, -0.45, 0.4}, {0, 0, 0});
  for (const auto& [name, print] :
       {std::pair<const char*, Print>{"wide", wide}, {"narrow", narrow}}) {
    for (const double turn : {0.4, 0.4 + M_PI}) {
      SCOPED_TRACE(std::string(name) + " at " + std::to_string(turn));
      const Pose truth = camera_from_world *
                         test::standing_at(0, 0, static_cast<double>(test::kBrickHalf.z()), turn);
      const auto found = detector.detect(picture(camera_from_world, truth, print));
      ASSERT_TRUE(found.ok()) << found.status().message;
      const auto& best = found->interpretations.at(0).placements;
      ASSERT_EQ(best.size(), 1u);
      EXPECT_EQ(best[0].model, name);
      EXPECT_LT(pose_error(best[0].frame_from_object, truth, about_x).angle, 0.1);
    }
  }
}

}  // namespace
}  // namespace bpa
