// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/cloud/texture.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/meshes.hpp"

namespace bpa::modeling {
namespace {

constexpr float kSpacing = 0.0025f;  // the default

ModelSource source_of(const TriangleMesh& mesh) {
  auto source = model_source_from_mesh(mesh, "thing", 3);
  EXPECT_TRUE(source.ok()) << source.status().message;
  return source.ok() ? std::move(source).value() : ModelSource{};
}

std::string refusal(const TriangleMesh& mesh) {
  const auto source = model_source_from_mesh(mesh, "thing", 1);
  EXPECT_EQ(source.status().code, StatusCode::invalid_argument);
  return source.status().message;
}

TriangleMesh scaled(TriangleMesh mesh, float factor) {
  for (auto& vertex : mesh.vertices) vertex *= factor;
  return mesh;
}

float nearest_distance(const NeighborGrid& grid, const Eigen::Vector3f& query, int except) {
  float nearest = std::numeric_limits<float>::infinity();
  grid.for_each_neighbor(query, [&](int j, float squared) {
    if (j != except) nearest = std::min(nearest, std::sqrt(squared));
  });
  return nearest;
}

// Distance outside a box, negative inside.
float box_distance(const Eigen::Vector3f& p, const Eigen::Vector3f& half) {
  const Eigen::Vector3f q = p.cwiseAbs() - half;
  return q.cwiseMax(0.0f).norm() + std::min(0.0f, q.maxCoeff());
}

const Eigen::Vector3f kBoxHalf(0.05f, 0.04f, 0.03f);

void expect_box_surface(const PointCloud& surface) {
  ASSERT_EQ(surface.normals.size(), surface.size());
  int near_edges = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3f& p = surface.points[i];
    // Means over cubes at an edge of the box lie a little inside.
    ASSERT_LT(std::abs(box_distance(p, kBoxHalf)), 0.5f * kSpacing);
    const Eigen::Vector3f to_face = (kBoxHalf - p.cwiseAbs());
    Eigen::Index axis = 0;
    to_face.minCoeff(&axis);
    const Eigen::Vector3f outward = (p[axis] > 0 ? 1.0f : -1.0f) * Eigen::Vector3f::Unit(axis);
    Eigen::Vector3f sorted = to_face;
    std::sort(sorted.data(), sorted.data() + 3);
    if (sorted[1] < kSpacing) {
      ++near_edges;
      EXPECT_GT(surface.normals[i].dot(p.cwiseQuotient(kBoxHalf)), -0.01f);
    } else {
      EXPECT_GT(surface.normals[i].dot(outward), 0.999f);
    }
  }
  EXPECT_LT(near_edges, static_cast<int>(surface.size()) / 3);
}

TEST(SurfaceSampling, BoxHasItsSurface) {
  const ModelSource source = source_of(test::box_mesh(kBoxHalf));
  EXPECT_EQ(source.name, "thing");
  EXPECT_EQ(source.number, 3);
  EXPECT_NEAR(source.diameter, 2 * kBoxHalf.norm(), 0.02 * source.diameter);
  expect_box_surface(source.surface);
}

TEST(SurfaceSampling, InsideOutMeshIsTurnedOutwards) {
  TriangleMesh mesh = test::inside_out(test::box_mesh(kBoxHalf));
  expect_box_surface(source_of(mesh).surface);
}

TEST(SurfaceSampling, InsideOutMeshMayBeFarFromItsOrigin) {
  const Eigen::Vector3f shift(0.9f, -0.6f, 0.4f);
  for (TriangleMesh mesh : {test::box_mesh(kBoxHalf), test::inside_out(test::box_mesh(kBoxHalf))}) {
    for (Eigen::Vector3f& vertex : mesh.vertices) vertex += shift;
    PointCloud surface = source_of(mesh).surface;
    for (Eigen::Vector3f& point : surface.points) point -= shift;
    expect_box_surface(surface);
  }
}

TEST(SurfaceSampling, PointsAreEvenlySpaced) {
  const PointCloud surface = source_of(test::box_mesh(kBoxHalf)).surface;
  const NeighborGrid grid(surface.points, 0.02f);
  double mean = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    mean += static_cast<double>(nearest_distance(grid, surface.points[i], static_cast<int>(i)));
  }
  mean /= static_cast<double>(surface.size());
  EXPECT_GT(mean, 0.6 * kSpacing);
  EXPECT_LT(mean, 1.1 * kSpacing);
  // No holes: every place of the top face has a point near.
  for (float x = -kBoxHalf.x(); x <= kBoxHalf.x(); x += 0.002f) {
    for (float y = -kBoxHalf.y(); y <= kBoxHalf.y(); y += 0.002f) {
      EXPECT_LT(nearest_distance(grid, {x, y, kBoxHalf.z()}, -1), 2 * kSpacing);
    }
  }
}

TEST(SurfaceSampling, SpacingIsAnOption) {
  ModelOptions coarse;
  coarse.spacing_m = 0.0045;
  const auto few = model_source_from_mesh(test::box_mesh(kBoxHalf), "a", 1, coarse);
  const auto many = model_source_from_mesh(test::box_mesh(kBoxHalf), "a", 1);
  ASSERT_TRUE(few.ok() && many.ok());
  const double ratio =
      static_cast<double>(many->surface.size()) / static_cast<double>(few->surface.size());
  EXPECT_NEAR(ratio, 0.0045 * 0.0045 / (0.0025 * 0.0025), 0.7);
  coarse.spacing_m = 0.5;
  const auto wrong = model_source_from_mesh(test::box_mesh(kBoxHalf), "a", 1, coarse);
  EXPECT_EQ(wrong.status().message, "spacing_m is 0.5; it must be between 0.0005 and 0.02");
}

TEST(SurfaceSampling, SmallObjectsAreSampledMoreFinely) {
  const ModelSource source = source_of(test::sphere_mesh(0.012));
  EXPECT_GT(source.surface.size(), 1200u);
  EXPECT_NEAR(source.diameter, 0.024, 0.0006);
}

TEST(SurfaceSampling, SphereHasItsNormals) {
  const PointCloud surface = source_of(test::sphere_mesh(0.05)).surface;
  ASSERT_GT(surface.size(), 3000u);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    EXPECT_NEAR(surface.points[i].norm(), 0.05f, 0.0004f);
    EXPECT_GT(surface.normals[i].dot(surface.points[i].normalized()), 0.995f);
  }
}

TEST(SurfaceSampling, WhatIsDeepInsideIsRemoved) {
  const Eigen::Vector3f half(0.08f, 0.07f, 0.075f);
  TriangleMesh mesh = test::box_mesh(half);
  test::add_box(mesh, {0.03f, 0.03f, 0.03f});
  const PointCloud surface = source_of(mesh).surface;
  ASSERT_GT(surface.size(), 10000u);
  for (const Eigen::Vector3f& p : surface.points) {
    ASSERT_LT(std::abs(box_distance(p, half)), 0.5f * kSpacing);
  }
}

// Every third triangle is turned over: by volume nothing can be said of a single one.
TEST(SurfaceSampling, SingleFlippedFacesAreTurnedOutwards) {
  TriangleMesh mesh = test::box_mesh(kBoxHalf);
  for (std::size_t k = 0; k < mesh.triangles.size(); k += 3) {
    std::swap(mesh.triangles[k][1], mesh.triangles[k][2]);
  }
  const ModelSource source = source_of(mesh);
  expect_box_surface(source.surface);
  ASSERT_EQ(source.warnings.size(), 1u);
  EXPECT_NE(source.warnings[0].find("faced inwards"), std::string::npos);
}

TEST(SurfaceSampling, FlippedFacesOfThinWallsAreTurnedToTheirSide) {
  constexpr double kOuter = 0.04, kWall = 0.002, kHeight = 0.08;
  TriangleMesh mesh = test::cup_mesh(kOuter, kWall, kHeight);
  for (std::size_t k = 0; k < mesh.triangles.size(); k += 2) {
    std::swap(mesh.triangles[k][1], mesh.triangles[k][2]);
  }
  const PointCloud surface = source_of(mesh).surface;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3f& p = surface.points[i];
    if (p.z() < 0.01f || p.z() > 0.07f || p.head<2>().norm() < 0.034f) continue;
    const float cosine = surface.normals[i].dot(Eigen::Vector3f(p.x(), p.y(), 0).normalized());
    EXPECT_NEAR(p.head<2>().norm(), cosine > 0 ? kOuter : kOuter - kWall, 0.0006);
  }
}

TEST(SurfaceSampling, OpenSheetHasTwoSides) {
  TriangleMesh mesh;
  test::add_quad(mesh, {-0.05f, -0.05f, 0}, {0.05f, -0.05f, 0}, {0.05f, 0.05f, 0},
                 {-0.05f, 0.05f, 0});
  const ModelSource source = source_of(mesh);
  int up = 0, down = 0;
  for (const Eigen::Vector3f& n : source.surface.normals) {
    EXPECT_GT(std::abs(n.z()), 0.999f);
    (n.z() > 0 ? up : down) += 1;
  }
  EXPECT_EQ(up, down);
  EXPECT_GT(up, 1200);
  ASSERT_EQ(source.warnings.size(), 2u);
  EXPECT_NE(source.warnings[0].find("one flat face"), std::string::npos);
  EXPECT_NE(source.warnings[1].find("open mesh"), std::string::npos);
}

TEST(SurfaceSampling, NonManifoldMeshesAreSampled) {
  TriangleMesh mesh = test::box_mesh(kBoxHalf);
  const auto first = mesh.triangles[0];
  mesh.triangles.push_back(first);                           // a face twice
  mesh.triangles.push_back({first[0], first[0], first[1]});  // one without area
  const auto far = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back({0, 0, 0.08f});
  mesh.triangles.push_back({first[0], first[1], far});  // a fin on an edge
  const ModelSource source = source_of(mesh);
  EXPECT_GT(source.surface.size(), 2500u);
  for (const Eigen::Vector3f& n : source.surface.normals) EXPECT_NEAR(n.norm(), 1, 1e-4);
}

TEST(SurfaceSampling, PartsMayOverlap) {
  const test::LShape l;
  const PointCloud surface = source_of(test::l_mesh(l)).surface;
  int outside = 0, inside = 0;
  for (const Eigen::Vector3f& p : surface.points) {
    const float distance = std::min(box_distance(p - l.foot_centre, l.foot_half),
                                    box_distance(p - l.tower_centre, l.tower_half));
    EXPECT_LT(distance, 0.5f * kSpacing);
    (distance > -0.5f * kSpacing ? outside : inside) += 1;
  }
  EXPECT_LT(inside, outside / 100) << "none but cubes across an edge";
}

TEST(SurfaceSampling, ThinWallKeepsBothSides) {
  constexpr double kOuter = 0.04, kWall = 0.002, kHeight = 0.08;
  const PointCloud surface = source_of(test::cup_mesh(kOuter, kWall, kHeight)).surface;
  int outer = 0, inner = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3f& p = surface.points[i];
    if (p.z() < 0.01f || p.z() > 0.07f) continue;
    const Eigen::Vector3f radial = Eigen::Vector3f(p.x(), p.y(), 0).normalized();
    const float r = p.head<2>().norm();
    if (r < 0.034f) continue;  // the floor
    const float cosine = surface.normals[i].dot(radial);
    ASSERT_GT(std::abs(cosine), 0.99f);
    EXPECT_NEAR(r, cosine > 0 ? kOuter : kOuter - kWall, 0.0006);
    (cosine > 0 ? outer : inner) += 1;
  }
  const double expected = 2 * M_PI * kOuter * 0.06 / (kSpacing * kSpacing);
  EXPECT_GT(outer, 0.9 * expected);
  EXPECT_GT(inner, 0.85 * expected);
}

TEST(SurfaceSampling, ColoursFollowTheVertices) {
  TriangleMesh mesh = test::box_mesh(kBoxHalf);
  for (const Eigen::Vector3f& v : mesh.vertices) {
    mesh.colors.push_back({static_cast<std::uint8_t>(v.x() > 0 ? 200 : 0), 10, 77});
  }
  const PointCloud surface = source_of(mesh).surface;
  ASSERT_EQ(surface.colors.size(), surface.size());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const float part = (surface.points[i].x() + kBoxHalf.x()) / (2 * kBoxHalf.x());
    EXPECT_NEAR(surface.colors[i][0], 200 * part, 8);
    EXPECT_EQ(surface.colors[i][1], 10);
  }
}

// Two triangles a face, each with the whole image: red on the left, blue on the right.
TEST(SurfaceSampling, ColoursOfATextureVaryInsideTriangles) {
  TriangleMesh mesh = test::box_mesh(kBoxHalf);
  RgbImage image(64, 64, {255, 0, 0});
  for (int i = 0; i < 64 * 64; ++i) {
    if (i % 64 >= 32) image.pixels[static_cast<std::size_t>(i)] = {0, 0, 255};
  }
  mesh.textures = {make_texture(image)};
  mesh.texture_of.assign(mesh.triangles.size(), 0);
  for (std::size_t k = 0; k < mesh.vertices.size(); k += 4) {
    mesh.uv.insert(mesh.uv.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  }
  const PointCloud surface = source_of(mesh).surface;
  ASSERT_EQ(surface.colors.size(), surface.size());
  int red = 0, blue = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    Eigen::Index axis = 0;
    if (surface.normals[i].cwiseAbs().maxCoeff(&axis) < 0.999f) continue;  // an edge of the box
    const float x = surface.points[i][(axis + 1) % 3];  // along which test::add_box draws
    if (std::abs(x) < 2 * kSpacing) continue;
    const std::array<std::uint8_t, 3> expected =
        x < 0 ? std::array<std::uint8_t, 3>{255, 0, 0} : std::array<std::uint8_t, 3>{0, 0, 255};
    EXPECT_EQ(surface.colors[i], expected);
    ++(x < 0 ? red : blue);
  }
  EXPECT_GT(std::min(red, blue), 1000);
}

TEST(SurfaceSampling, WrongUnitsAreRefusedWithAHint) {
  const TriangleMesh mesh = test::box_mesh(kBoxHalf);
  for (const float factor : {1000.0f, 0.001f}) {
    EXPECT_NE(refusal(scaled(mesh, factor)).find("--unit mm, cm, m or in"), std::string::npos);
  }
}

TEST(SurfaceSampling, TooManyTrianglesAreRefusedBeforeTheWork) {
  TriangleMesh mesh = test::box_mesh(kBoxHalf);
  mesh.triangles.resize(1'500'001, mesh.triangles[0]);
  EXPECT_NE(refusal(mesh).find("1500001 triangles; it must have at most 1500000: simplify"),
            std::string::npos);
}

/// Scans of most formats have vertices of their own for each corner: those count once.
TEST(SurfaceSampling, TooManyVerticesAreRefusedBeforeTheWork) {
  TriangleMesh mesh = test::box_mesh(kBoxHalf);
  const Eigen::Vector3f corner = mesh.vertices[0];
  mesh.vertices.resize(1'500'000, corner);
  EXPECT_FALSE(source_of(mesh).surface.points.empty());
  for (std::size_t i = 8; i < mesh.vertices.size(); ++i) {
    mesh.vertices[i] = corner * (1 - 1e-7f * static_cast<float>(i));
  }
  EXPECT_NE(refusal(mesh).find("vertices; it must have at most 1000000: join them"),
            std::string::npos);
}

/// No two of them are equal: it took minutes.
TEST(SurfaceSampling, FacesThatNearlyCoincideAreRefusedBeforeTheWork) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const float z = 1e-6f * static_cast<float>(i);
    for (const auto& [x, y] :
         {std::pair(0.0f, 0.0f), std::pair(0.05f, 0.0f), std::pair(0.0f, 0.05f)})
      mesh.vertices.emplace_back(x, y, z);
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_NE(refusal(mesh).find("2.50 m2 of faces within 0.071 m: they lie over each other"),
            std::string::npos);
}

// What time and memory grow with.
TEST(SurfaceSampling, LargeObjectsHaveNoMorePoints) {
  for (const float side : {1.0f, 1.7f}) {
    const ModelSource source = source_of(test::box_mesh(Eigen::Vector3f::Constant(side / 2)));
    EXPECT_LT(source.surface.size(), 45000u);
    EXPECT_GT(source.surface.size(), 20000u);
    EXPECT_NE(source.warnings.back().find("points are"), std::string::npos);
    PointCloud cloud;
    for (int axis = 0; axis < 3; ++axis) {
      for (int k = 0; k < 500 * 500; ++k) {
        Eigen::Vector3f p(side, side * static_cast<float>(k % 500) / 500,
                          side * static_cast<float>(k / 500) / 500);
        std::rotate(p.data(), p.data() + axis, p.data() + 3);
        cloud.points.push_back(p);
      }
    }
    const auto points = model_source_from_points(cloud, "cloud", 1);
    ASSERT_TRUE(points.ok()) << points.status().message;
    EXPECT_LT(points->surface.size(), 45000u);
    EXPECT_NE(points->warnings.back().find("points are"), std::string::npos);
  }
}

TEST(SurfaceSampling, MeshWithoutSurfaceIsRefused) {
  const char* expected = "model thing has no surface; the mesh must have triangles";
  EXPECT_EQ(refusal({}), expected);
  TriangleMesh mesh = test::box_mesh(kBoxHalf);
  mesh.triangles.clear();
  EXPECT_EQ(refusal(mesh), expected);
  mesh = scaled(test::box_mesh(kBoxHalf), 0);
  EXPECT_EQ(refusal(mesh), expected);
  mesh = test::box_mesh(kBoxHalf);
  mesh.vertices[0].x() = std::nanf("");
  EXPECT_EQ(refusal(mesh), expected);
}

TEST(SurfaceSampling, SameMeshSameModelForAnyThreads) {
  ModelOptions options;
  options.num_threads = 1;
  const auto one = model_source_from_mesh(test::l_mesh(), "l", 1, options);
  options.num_threads = 8;
  const auto many = model_source_from_mesh(test::l_mesh(), "l", 1, options);
  ASSERT_TRUE(one.ok() && many.ok());
  EXPECT_EQ(one->surface.points, many->surface.points);
  EXPECT_EQ(one->surface.normals, many->surface.normals);
}

TEST(SurfaceFromPoints, KeepsGivenNormals) {
  const PointCloud dense = source_of(test::sphere_mesh(0.05)).surface;
  ModelOptions options;
  options.spacing_m = 0.005;
  const auto source = model_source_from_points(dense, "ball", 2, options);
  ASSERT_TRUE(source.ok());
  EXPECT_LT(source->surface.size(), dense.size() / 2);
  EXPECT_NEAR(source->diameter, 0.1, 0.002);
  for (std::size_t i = 0; i < source->surface.size(); ++i) {
    const Eigen::Vector3f radial = source->surface.points[i].normalized();
    EXPECT_GT(source->surface.normals[i].dot(radial), 0.99f);
  }
}

// Of a ball about the origin, sampled at random, with the normals that a file may have.
TEST(SurfaceFromPoints, UnusableNormalsOfAClosedSurfaceAreEstimatedAndPointOutwards) {
  RandomStream random(3);
  const auto unit = [&random] {
    const Eigen::Vector3d v(random.normal(), random.normal(), random.normal());
    return Eigen::Vector3f(v.normalized().cast<float>());
  };
  const float nan = std::nanf("");
  const std::pair<const char*, std::function<Eigen::Vector3f()>> all[] = {
      {"zero", [] { return Eigen::Vector3f(0, 0, 0); }},
      {"nan", [nan] { return Eigen::Vector3f(nan, nan, nan); }},
      {"constant", [] { return Eigen::Vector3f(1, 0, 0); }},
      {"random", unit},
      {"none", nullptr}};
  for (const auto& [name, normal] : all) {
    SCOPED_TRACE(name);
    PointCloud cloud;
    for (int i = 0; i < 1200; ++i) {
      cloud.points.emplace_back(0.05f * unit());
      if (normal) cloud.normals.push_back(normal());
    }
    const auto source = model_source_from_points(cloud, "ball", 1);
    ASSERT_TRUE(source.ok()) << source.status().message;
    EXPECT_TRUE(source->complete);
    EXPECT_GT(source->surface.size(), 900u);
    for (std::size_t i = 0; i < source->surface.size(); ++i) {
      EXPECT_GT(source->surface.normals[i].dot(source->surface.points[i].normalized()), 0.9f);
    }
  }
}

TEST(SurfaceFromPoints, OneViewGetsNormalsTowardTheCamera) {
  PointCloud view;
  for (int k = 0; k < 100 * 100; ++k) {
    const float x = 0.001f * static_cast<float>(k % 100 - 50);
    const float y = 0.001f * static_cast<float>(k / 100 - 50);
    view.points.push_back({x, y, 0.6f + 0.5f * x});
  }
  const auto source = model_source_from_points(view, "flat", 1);
  ASSERT_TRUE(source.ok());
  const Eigen::Vector3f normal = Eigen::Vector3f(0.5f, 0, -1).normalized();
  for (const Eigen::Vector3f& n : source->surface.normals) EXPECT_GT(n.dot(normal), 0.999f);
  EXPECT_FALSE(source->complete);
}

TEST(SurfaceFromPoints, ACornerOfThreeFacesIsOneView) {
  PointCloud view;
  for (int k = 0; k < 3 * 40 * 40; ++k) {
    Eigen::Vector3f p(0, 0.002f * static_cast<float>(k % 40),
                      0.002f * static_cast<float>(k / 40 % 40));
    std::rotate(p.data(), p.data() + k / 1600, p.data() + 3);
    view.points.emplace_back(p + Eigen::Vector3f(0.3f, 0.3f, 0.4f));  // its point nearest
  }
  const auto source = model_source_from_points(view, "corner", 1);
  ASSERT_TRUE(source.ok());
  EXPECT_FALSE(source->complete);
  for (std::size_t i = 0; i < source->surface.size(); ++i) {
    EXPECT_LT(source->surface.normals[i].dot(source->surface.points[i]), 0);
  }
}

TEST(SurfaceFromPoints, RefusesTooFewAndWrongUnits) {
  PointCloud cloud;
  cloud.points.assign(99, Eigen::Vector3f::Zero());
  EXPECT_EQ(model_source_from_points(cloud, "few", 1).status().message,
            "model few has 99 points; it must have at least 100");
  cloud.points.assign(200, Eigen::Vector3f::Zero());
  cloud.points.back() = {500, 0, 0};
  EXPECT_NE(model_source_from_points(cloud, "big", 1).status().message.find("--unit mm"),
            std::string::npos);
}

}  // namespace
}  // namespace bpa::modeling
