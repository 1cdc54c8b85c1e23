// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/planes.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/solid_scene.hpp"

namespace bpa {
namespace {

using test::Solid;

const Pose kCameraFromWorld = test::look_at({0.1, -0.9, 0.7}, {0, 0, 0});

Solid box_on_table(double x, double y, const Eigen::Vector3d& half, double angle) {
  return {Solid::Kind::box, half, kCameraFromWorld * test::standing_at(x, y, half.z(), angle)};
}

// How much of what is seen of each solid is still searched.
std::vector<double> searched_part(const SurfaceMap& map, const test::SolidImage& image,
                                  std::size_t solids) {
  std::vector<double> searched(solids, 0), all(solids, 0);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const int solid = image.solid[image.index_of(map, i)];
    if (solid < 0 || map.normals[i].squaredNorm() == 0) continue;
    all[static_cast<std::size_t>(solid)] += 1;
    searched[static_cast<std::size_t>(solid)] += map.searched[i];
  }
  for (std::size_t k = 0; k < solids; ++k) searched[k] /= all[k];
  return searched;
}

void expect_table(const Plane& plane) {
  const Eigen::Vector3d up = kCameraFromWorld.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_GT(plane.normal.cast<double>().dot(up), std::cos(0.005));
  EXPECT_NEAR(plane.offset, up.dot(kCameraFromWorld.translation), 0.002);
  EXPECT_LT(plane.offset, 0) << "the normal is toward the camera";
}

class Planes : public ::testing::TestWithParam<float> {};

TEST_P(Planes, LabelTheTableAndLeaveTheBoxes) {
  const std::vector<Solid> solids{test::table(kCameraFromWorld),
                                  box_on_table(0.05, -0.1, {0.09, 0.06, 0.10}, 0.5),
                                  box_on_table(-0.25, 0.1, {0.10, 0.12, 0.025}, 1.1)};
  const auto image = test::render(solids, test::kinect_camera(), GetParam(), 3);
  SurfaceMap map = surface_map(image.frame, {});
  const auto planes = label_background_planes(map, {});
  ASSERT_EQ(planes.size(), 1u);
  expect_table(planes[0]);
  const auto searched = searched_part(map, image, solids.size());
  EXPECT_LT(searched[0], 0.02);
  EXPECT_GT(searched[1], 0.96);
  EXPECT_GT(searched[2], 0.90);
}

INSTANTIATE_TEST_SUITE_P(Noise, Planes, ::testing::Values(0.0f, 1.0f));

TEST(Transformed, HeightsAboveAPlaneStay) {
  const Plane plane{Eigen::Vector3f(0.6f, 0, 0.8f), 0.3f};
  const Pose a_from_b{rotation_from_vector({0.4, -0.9, 0.3}), {0.2, -0.5, 1.1}};
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.7, -0.2, 1.5)}) {
    const Eigen::Vector3d moved = a_from_b * point;
    EXPECT_NEAR(transformed(a_from_b, plane).height(moved.cast<float>()),
                plane.height(point.cast<float>()), 1e-5);
  }
}

TEST(PlanesOf, TableAndWallComeLargestFirst) {
  const Solid wall{
      Solid::Kind::box, {0.7, 0.02, 0.3}, kCameraFromWorld * test::standing_at(0, 0.5, 0.3, 0)};
  const std::vector<Solid> solids{test::table(kCameraFromWorld), wall,
                                  box_on_table(0, -0.1, {0.08, 0.08, 0.08}, 0.4)};
  const auto image = test::render(solids, test::kinect_camera(), 0.5f, 4);
  SurfaceMap map = surface_map(image.frame, {});
  const auto planes = label_background_planes(map, {});
  ASSERT_EQ(planes.size(), 2u);
  expect_table(planes[0]);
  const Eigen::Vector3d to_us = kCameraFromWorld.rotation * -Eigen::Vector3d::UnitY();
  EXPECT_GT(planes[1].normal.cast<double>().dot(to_us), std::cos(0.01));
  const auto searched = searched_part(map, image, solids.size());
  EXPECT_LT(searched[0], 0.03);
  EXPECT_LT(searched[1], 0.06);
  EXPECT_GT(searched[2], 0.95);
}

TEST(PlanesOf, AFaceOfABoxIsNotBackground) {
  // Nothing but a box of 25 cm.
  const std::vector<Solid> solids{box_on_table(0, 0, {0.125, 0.125, 0.125}, 0.6)};
  const auto image = test::render(solids, test::kinect_camera());
  SurfaceMap map = surface_map(image.frame, {});
  EXPECT_TRUE(label_background_planes(map, {}).empty());
  EXPECT_EQ(searched_part(map, image, 1)[0], 1.0);
}

TEST(PlanesOf, WhatIsNotSearchedDoesNotCount) {
  auto image = test::render({test::table(kCameraFromWorld)}, test::kinect_camera());
  image.frame.roi = {310, 230, 40, 40};
  SurfaceMap map = surface_map(image.frame, {});
  EXPECT_TRUE(label_background_planes(map, {}).empty()) << "too small in the region of interest";
}

TEST(PlanesOf, NothingHasNone) {
  Frame frame;
  frame.camera = test::kinect_camera();
  frame.depth.assign(640 * 480, 0.0f);
  SurfaceMap map = surface_map(frame, {});
  EXPECT_TRUE(label_background_planes(map, {}).empty());
}

TEST(PlanesOf, SameSeedSameLabels) {
  const auto image = test::render({test::table(kCameraFromWorld)}, test::kinect_camera(), 1, 6);
  SurfaceMap first = surface_map(image.frame, {});
  SurfaceMap second = first;
  label_background_planes(first, {});
  label_background_planes(second, {});
  EXPECT_EQ(first.searched, second.searched);
}

}  // namespace
}  // namespace bpa
