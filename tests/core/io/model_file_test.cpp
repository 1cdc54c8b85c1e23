// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bpa/core/io/model_file.hpp>

#include "support/temporary_folder.hpp"

namespace bpa::io {
namespace {

using test::slurp;
using test::spill;

ModelSource some_model(const std::string& name, int number) {
  ModelSource model;
  model.name = name;
  model.number = number;
  model.source = "by hand";
  model.diameter = 0.1 + 1e-9;
  model.symmetry.discrete = {{Eigen::Quaterniond(0.1, 0.2, 0.3, 0.4).normalized(), {1, 2, 3}}};
  model.symmetry.continuous = {{Eigen::Vector3d(0, 0.6, 0.8), {0.01, 0.02, 0.03}}};
  for (int i = 0; i < 50; ++i) {
    model.surface.points.emplace_back(0.001f * static_cast<float>(i), 0.1f, -0.2f);
    model.surface.normals.push_back(Eigen::Vector3f(1, 2, static_cast<float>(i)).normalized());
    model.surface.colors.push_back({static_cast<std::uint8_t>(i), 0, 255});
  }
  return model;
}

TEST(ModelFile, SurvivesToTheLastBit) {
  const test::TemporaryFolder folder;
  const ModelSource model = some_model("a-1.b_C", 3);
  ASSERT_TRUE(save_model(folder.path(), model).ok());
  ASSERT_TRUE(save_model(folder.path(), model).ok()) << "replacing";
  const Result<ModelSource> back = load_model(folder.path(), model.name);
  ASSERT_TRUE(back.ok()) << back.status().message;
  EXPECT_EQ(back->number, 3);
  EXPECT_EQ(back->source, model.source);
  EXPECT_EQ(back->diameter, model.diameter);
  EXPECT_EQ(back->surface.points, model.surface.points);
  EXPECT_EQ(back->surface.colors, model.surface.colors);
  ASSERT_EQ(back->surface.normals.size(), model.surface.normals.size());
  for (std::size_t i = 0; i < model.surface.normals.size(); ++i) {
    EXPECT_LT((back->surface.normals[i] - model.surface.normals[i]).norm(), 1e-6f);
  }
  ASSERT_EQ(back->symmetry.discrete.size(), 1u);
  EXPECT_EQ(back->symmetry.discrete[0].rotation.coeffs(),
            model.symmetry.discrete[0].rotation.coeffs());
  EXPECT_EQ(back->symmetry.continuous.at(0).point, model.symmetry.continuous[0].point);
}

TEST(ModelFile, LibrariesAreOrderedByNumber) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(save_model(folder.path(), some_model("a", 9)).ok());
  ASSERT_TRUE(save_model(folder.path(), some_model("b", 2)).ok());
  const auto models = load_library(folder.path());
  ASSERT_TRUE(models.ok()) << models.status().message;
  ASSERT_EQ(models->size(), 2u);
  EXPECT_EQ(models->at(0).name, "b");
  EXPECT_EQ(list_models(folder.path()), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(save_model(folder.path(), some_model("c", 9)).code, StatusCode::invalid_argument);
  ASSERT_TRUE(remove_model(folder.path(), "a").ok());
  EXPECT_EQ(remove_model(folder.path(), "a").code, StatusCode::not_found);
  EXPECT_EQ(load_library(folder.path())->size(), 1u);
}

TEST(ModelFile, DamageIsSaid) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(save_model(folder.path(), some_model("a", 1)).ok());
  const std::string surface = slurp(folder / "a/surface.ply");
  const std::string json = slurp(folder / "a/model.json");
  const auto message = [&] {
    const Status status = load_library(folder.path()).status();
    EXPECT_EQ(status.code, StatusCode::corrupt);
    return status.message;
  };
  spill(folder / "a/surface.ply", surface.substr(0, surface.size() - 5));
  EXPECT_NE(message().find("truncated"), std::string::npos);
  std::string altered = surface;
  altered.back() = static_cast<char>(altered.back() ^ 1);
  spill(folder / "a/surface.ply", altered);
  EXPECT_NE(message().find("altered"), std::string::npos);
  spill(folder / "a/surface.ply", surface);
  spill(folder / "a/model.json", json.substr(0, json.size() / 2));
  EXPECT_NE(message().find("truncated"), std::string::npos);
  std::string newer = json;
  newer.replace(newer.find("\"version\": 1"), 12, "\"version\": 2");
  spill(folder / "a/model.json", newer);
  EXPECT_NE(message().find("version 2"), std::string::npos);
}

TEST(ModelFile, EmptyAndMissingLibraries) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(load_library(folder.path()).status().code, StatusCode::invalid_argument);
  EXPECT_EQ(load_library(folder / "none").status().code, StatusCode::not_found);
  EXPECT_EQ(load_model(folder.path(), "../x").status().code, StatusCode::not_found);
  EXPECT_EQ(save_model(folder.path(), some_model("../x", 1)).code, StatusCode::invalid_argument);
  EXPECT_EQ(save_model(folder.path(), some_model("x", 0)).code, StatusCode::invalid_argument);
  EXPECT_EQ(clean_model_name("a b/c"), "a_b_c");
  EXPECT_EQ(clean_model_name("..x"), "_..x");
}

}  // namespace
}  // namespace bpa::io
