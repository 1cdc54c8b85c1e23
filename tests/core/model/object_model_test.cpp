// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/object_model.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "core/model/model_index.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/meshes.hpp"

namespace bpa {
namespace {

ModelSource l_source() {
  auto source = modeling::model_source_from_mesh(test::l_mesh(), "l", 4);
  EXPECT_TRUE(source.ok());
  return std::move(source).value();
}

std::array<float, 6> key(const Eigen::Vector3f& p, const Eigen::Vector3f& n) {
  return {p.x(), p.y(), p.z(), n.x(), n.y(), n.z()};
}

TEST(ObjectModel, KeepsItsSource) {
  ModelSource source = l_source();
  source.symmetry.continuous.push_back({});
  source.source = "l.ply";
  const auto model = make_object_model(source);
  ASSERT_TRUE(model.ok());
  const ObjectModel& made = **model;
  EXPECT_EQ(made.name, "l");
  EXPECT_EQ(made.number, 4);
  EXPECT_EQ(made.source, "l.ply");
  EXPECT_EQ(made.symmetry.continuous.size(), 1u);
  EXPECT_EQ(made.surface.points, source.surface.points);
}

TEST(ObjectModel, CheckPointsAreAFairSampleOfTheSurface) {
  const ModelSource source = l_source();
  const auto model = make_object_model(source);
  ASSERT_TRUE(model.ok());
  std::set<std::array<float, 6>> surface;
  for (std::size_t i = 0; i < source.surface.size(); ++i) {
    surface.insert(key(source.surface.points[i], source.surface.normals[i]));
  }
  const CheckPoints& check = (*model)->index->check;
  ASSERT_EQ(check.points.size(), 1024u);
  Eigen::Vector3f mean = Eigen::Vector3f::Zero(), part_mean = mean, surface_mean = mean;
  for (std::size_t i = 0; i < check.points.size(); ++i) {
    EXPECT_EQ(surface.erase(key(check.points[i], check.normals[i])), 1u) << "each at most once";
    mean += check.points[i] / 1024;
    if (i < 256) part_mean += check.points[i] / 256;
  }
  for (const auto& p : source.surface.points) {
    surface_mean += p / static_cast<float>(source.surface.size());
  }
  EXPECT_LT((mean - surface_mean).norm(), 0.006f);
  EXPECT_LT((part_mean - surface_mean).norm(), 0.012f);
}

TEST(ObjectModel, IndexIsComplete) {
  const auto model = make_object_model(l_source());
  ASSERT_TRUE(model.ok());
  const ModelIndex& index = *(*model)->index;
  ASSERT_GT(index.features.size(), 200u);
  EXPECT_EQ(index.fpfh.size(), index.features.size());
  EXPECT_EQ(index.features.principal_directions.size(), index.features.size());
  EXPECT_EQ(index.views.size(), static_cast<std::size_t>(kNumViews));
  EXPECT_GT(index.coarse.size(), 50u);
  EXPECT_LE(index.coarse.size(), 500u);
  EXPECT_NEAR(index.pairs.max_distance(), (*model)->diameter, 0.15 * (*model)->diameter);
  for (std::size_t k = 0; k < index.fpfh.size(); k += 29) {
    const auto match = index.feature_tree.nearest(std::span(index.fpfh).subspan(k, 1), 1, 1);
    EXPECT_EQ(match[0].squared_distance, 0) << "the tree holds the features";
  }
}

TEST(ObjectModel, IsTheSameForAnyThreads) {
  const auto one = make_object_model(l_source(), 1);
  const auto many = make_object_model(l_source(), 8);
  ASSERT_TRUE(one.ok() && many.ok());
  EXPECT_EQ((*one)->index->fpfh, (*many)->index->fpfh);
  EXPECT_EQ((*one)->index->check.points, (*many)->index->check.points);
  EXPECT_EQ((*one)->index->features.curvatures, (*many)->index->features.curvatures);
  for (std::size_t v = 0; v < (*one)->index->views.size(); ++v) {
    EXPECT_EQ((*one)->index->views[v].visible, (*many)->index->views[v].visible);
    EXPECT_EQ((*one)->index->views[v].outward, (*many)->index->views[v].outward);
  }
}

TEST(ObjectModel, RefusesASourceWithoutSurfaceOrDiameter) {
  ModelSource source = l_source();
  source.diameter = 0;
  EXPECT_EQ(make_object_model(source).status().message,
            "model l has no diameter; it must be positive");
  source.diameter = std::nan("");
  EXPECT_FALSE(make_object_model(source).ok());
  source = l_source();
  source.surface.normals.clear();
  EXPECT_EQ(make_object_model(source).status().code, StatusCode::invalid_argument);
  EXPECT_FALSE(make_object_model(ModelSource{}).ok());
}

TEST(ObjectModel, LargeObjectsStayWithinTheLimits) {
  auto source =
      modeling::model_source_from_mesh(test::box_mesh({0.5f, 0.4f, 0.3f}), "crate", 1, {0.02, 0});
  ASSERT_TRUE(source.ok());
  const auto model = make_object_model(std::move(source).value());
  ASSERT_TRUE(model.ok());
  EXPECT_LE((*model)->index->coarse.size(), 500u);
  // Sparse as its points are, the surface has no holes: the edges of a face seen straight on are
  // at its border.
  const ModelIndex& index = *(*model)->index;
  const Eigen::Vector3f above = Eigen::Vector3f::UnitZ();
  const ModelView& view = nearest_view(index.views, above);
  EXPECT_GT(view.edges.size(), 100u);
  for (const std::uint32_t i : view.edges) {
    const Eigen::Vector3f& p = (*model)->surface.points[i];
    EXPECT_FALSE(std::abs(p.x()) < 0.4f && std::abs(p.y()) < 0.3f) << p.transpose();
  }
}

}  // namespace
}  // namespace bpa
