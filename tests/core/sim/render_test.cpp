// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/render.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/cloud/texture.hpp"
#include "core/sim/distance_field.hpp"

namespace bpa::sim {
namespace {

const Camera kCamera{160, 120, 140, 140, 79.5, 59.5};

TriangleMesh box_mesh(const Eigen::Vector3f& half) {
  TriangleMesh mesh;
  for (int c = 0; c < 8; ++c) {
    mesh.vertices.push_back(half.cwiseProduct(
        Eigen::Vector3f(c & 1 ? 1.f : -1.f, c & 2 ? 1.f : -1.f, c & 4 ? 1.f : -1.f)));
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TriangleMesh sphere_mesh(double radius) {
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(radius + 0.01);
  return mesh_from_field([radius](const Eigen::Vector3d& p) { return p.norm() - radius; }, -reach,
                         reach, 0.002);
}

TEST(Render, SphereDepthAgreesWithTheClosedForm) {
  const double radius = 0.1;
  const Eigen::Vector3d center(0.02, -0.01, 0.6);
  const TriangleMesh mesh = sphere_mesh(radius);
  const RayMeshes meshes({&mesh});
  const RayScene scene(meshes, {{0, {Eigen::Quaterniond(0.8, 0.6, 0, 0), center}}});
  const RenderedImage image = render(scene, kCamera, Pose{}, std::nullopt, 1);
  int checked = 0;
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const Eigen::Vector3d d = kCamera.unproject(x, y, 1);
      const double b = d.dot(center), a = d.squaredNorm();
      const double root = b * b - a * (center.squaredNorm() - radius * radius);
      const float depth = image.depth[y * kCamera.width + x];
      if (root < -1e-4) {
        EXPECT_EQ(depth, 0);
      }
      if (root < 0.003) continue;  // near the silhouette
      const double expected = (b - std::sqrt(root)) / a;
      EXPECT_NEAR(depth, expected, 1e-4);
      const Eigen::Vector3d normal = (expected * d - center) / radius;
      EXPECT_GT(image.normals[y * kCamera.width + x].cast<double>().dot(normal), 0.999);
      ++checked;
    }
  }
  EXPECT_GT(checked, 1000);
}

TEST(Render, TiltedPlaneAndPosedCamera) {
  // A big thin box seen by a camera that is moved and turned: depth follows from the plane alone.
  const TriangleMesh mesh = box_mesh({5, 5, 0.01f});
  const RayMeshes meshes({&mesh});
  const RayScene scene(meshes, {{0, Pose{Eigen::Quaterniond::Identity(), {0, 0, -0.01}}}});
  Pose world_from_camera;
  world_from_camera.rotation = Eigen::AngleAxisd(std::numbers::pi - 0.6, Eigen::Vector3d::UnitX());
  world_from_camera.translation = {0.3, -0.2, 1.1};
  const RenderedImage image = render(scene, kCamera, world_from_camera, Shading{}, 2);
  for (int y = 0; y < kCamera.height; y += 7) {
    for (int x = 0; x < kCamera.width; x += 7) {
      const Eigen::Vector3d d = world_from_camera.rotation * kCamera.unproject(x, y, 1);
      EXPECT_NEAR(image.depth[y * kCamera.width + x], -1.1 / d.z(), 1e-5);
      EXPECT_EQ(image.instance[y * kCamera.width + x], 0);
    }
  }
  EXPECT_EQ(image.color.size(), 3u * 160 * 120);
}

TEST(Render, OcclusionAndBorderLowerTheVisibleFraction) {
  const TriangleMesh mesh = box_mesh({0.1f, 0.1f, 0.01f});
  const RayMeshes meshes({&mesh});
  const Eigen::Quaterniond straight = Eigen::Quaterniond::Identity();
  // 1 is half hidden behind 0; 2 is half beyond the right border; 3 is free.
  const double edge = (kCamera.width - 0.5 - kCamera.cx) / kCamera.fx * 0.6;
  const RayScene scene(meshes, {{0, {straight, {-0.1, 0.05, 0.3}}},
                                {0, {straight, {-0.1 * 2, 0.05 * 2 - 0.1, 0.6}}},
                                {0, {straight, {edge, -0.1, 0.61}}},
                                {0, {straight, {0.1, 0.12, 0.6}}}});
  const RenderedImage image = render(scene, kCamera, Pose{}, std::nullopt, 1);
  const auto seen = visibility(scene, image, kCamera, Pose{}, 4, 2);
  EXPECT_NEAR(seen[2].fraction(), 0.5, 0.03);
  EXPECT_EQ(seen[3].fraction(), 1);
  EXPECT_LT(seen[1].fraction(), 0.6);
  EXPECT_GT(seen[1].all_pixels, 40 * 40);
}

TEST(Render, TexturesAreLookedUpForEachPixelAndBlurredByDistance) {
  TriangleMesh
      mesh;  // a square across the view; rows of the image run down, as those of the camera
  mesh.vertices = {{-0.1f, 0.1f, 0}, {0.1f, 0.1f, 0}, {0.1f, -0.1f, 0}, {-0.1f, -0.1f, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.texture_of = {0, 0};
  const auto color_at = [&](const RgbImage& texture, double distance, int x, int y) {
    mesh.textures = {make_texture(texture)};
    const RayMeshes meshes({&mesh});
    const RayScene scene(meshes, {{0, Pose{Eigen::Quaterniond::Identity(), {0, 0, distance}}}});
    Shading even;
    even.lights.clear();
    even.ambient = 2;  // half of it falls on what faces down the z axis
    const std::vector<std::uint8_t> color = render(scene, kCamera, Pose{}, even, 1).color;
    const std::size_t pixel = 3 * (static_cast<std::size_t>(y) * 160 + static_cast<std::size_t>(x));
    return std::array<int, 3>{color[pixel], color[pixel + 1], color[pixel + 2]};
  };
  RgbImage corners(2, 2, {});
  corners.pixels = {{100, 0, 0}, {0, 100, 0}, {0, 0, 100}, {100, 100, 0}};
  // At 0.4 m a pixel is 2.9 mm; the middles of the quarters are 17.5 pixels off the centre.
  EXPECT_NEAR(color_at(corners, 0.4, 62, 42)[0], 100, 4);
  EXPECT_NEAR(color_at(corners, 0.4, 97, 42)[1], 100, 4);
  EXPECT_NEAR(color_at(corners, 0.4, 62, 77)[2], 100, 4);
  EXPECT_NEAR(color_at(corners, 0.4, 62, 77)[0], 0, 4);
  RgbImage board(256, 256, {});
  for (int i = 0; i < 256 * 256; ++i) {
    const int bright = (i % 256 + i / 256) % 2;
    board.pixels[static_cast<std::size_t>(i)].fill(static_cast<std::uint8_t>(200 * bright));
  }
  EXPECT_NEAR(color_at(board, 0.4, 61, 53)[0], 100, 2);
  EXPECT_NEAR(color_at(board, 0.4, 66, 58)[0], 100, 2);
}

TEST(Render, NoThreadCountChangesTheImage) {
  const TriangleMesh mesh = sphere_mesh(0.1);
  const RayMeshes meshes({&mesh});
  const RayScene scene(meshes, {{0, {Eigen::Quaterniond::Identity(), {0, 0, 0.5}}}});
  const RenderedImage one = render(scene, kCamera, Pose{}, Shading{}, 1);
  const RenderedImage three = render(scene, kCamera, Pose{}, Shading{}, 3);
  EXPECT_EQ(one.depth, three.depth);
  EXPECT_EQ(one.color, three.color);
}

TEST(Render, RaysToThePointAreBlockedOnlyByWhatLiesBetween) {
  const TriangleMesh mesh = box_mesh({0.1f, 0.1f, 0.1f});
  const RayMeshes meshes({&mesh});
  const RayScene scene(meshes, {{0, Pose{}}});
  EXPECT_TRUE(scene.blocked({0, 0, -1}, {0, 0, 1}));
  EXPECT_FALSE(scene.blocked({0, 0, -1}, {0, 0, -0.1f}));
  EXPECT_FALSE(scene.blocked({0.2f, 0, -1}, {0.2f, 0, 1}));
}

}  // namespace
}  // namespace bpa::sim
