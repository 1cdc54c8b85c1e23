// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bpa/core/io/file_bytes.hpp>
#include <bpa/core/io/model_file.hpp>
#include <bpa/core/io/model_index_file.hpp>
#include <bpa/core/model/model_index.hpp>

#include "support/meshes.hpp"
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
    model.normal_variance.push_back(0.01f * static_cast<float>(i));
  }
  model.symmetry_origin = SymmetryOrigin::declared;
  model.noise.range.edge_height = 1.0 / 3;
  model.noise.normal.angle_width = 0.7;
  model.noise.depth = 0.9;
  model.noise.fitted = true;
  model.warnings = {"its \"foot\" was never seen"};
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
  EXPECT_EQ(back->symmetry_origin, SymmetryOrigin::declared);
  EXPECT_EQ(back->normal_variance, model.normal_variance);
  EXPECT_EQ(back->noise.range_sigma(0.003, 1.1, 1.3), model.noise.range_sigma(0.003, 1.1, 1.3));
  EXPECT_EQ(back->noise.normal_sigma(0.003, 1.1), model.noise.normal_sigma(0.003, 1.1));
  EXPECT_TRUE(back->noise.fitted);
  EXPECT_EQ(back->warnings, model.warnings);
}

// What detection reads from the file is what it would compute from the surface.
TEST(ModelFile, StoredIndexIsTheComputedOne) {
  const test::TemporaryFolder folder;
  const auto source = model_source_from_mesh(test::l_mesh(), "l", 1);
  ASSERT_TRUE(source.ok());
  ASSERT_TRUE(save_model(folder.path(), *source).ok());
  const auto stored = load_model(folder.path(), "l");
  ASSERT_TRUE(stored.ok()) << stored.status().message;
  ASSERT_NE(stored->prepared, nullptr);
  const auto made = make_object_model(*stored);
  ASSERT_TRUE(made.ok());
  EXPECT_EQ((*made)->index, stored->prepared);
  ModelSource bare = *stored;
  bare.prepared.reset();
  const auto index = build_index(bare, 2);
  const ModelIndex& read = *stored->prepared;
  ASSERT_EQ(read.fpfh.size(), index->fpfh.size());
  EXPECT_EQ(read.features.points, index->features.points);
  for (std::size_t i = 0; i < read.fpfh.size(); ++i) {  // PLY normals come back rounded
    EXPECT_LT((read.features.curvatures[i] - index->features.curvatures[i]).norm(), 1e-5f);
    EXPECT_NEAR(read.features.principal_directions[i].norm(), 1, 1e-5);
  }
  EXPECT_EQ(read.coarse.points, index->coarse.points);
  EXPECT_EQ(read.check.points, index->check.points);
  EXPECT_EQ(read.distances.nearest, index->distances.nearest);
  EXPECT_EQ(read.distances.low, index->distances.low);
  ASSERT_EQ(read.views.size(), index->views.size());
  for (std::size_t v = 0; v < read.views.size(); ++v) {
    EXPECT_EQ(read.views[v].direction, index->views[v].direction);
    EXPECT_EQ(read.views[v].visible, index->views[v].visible);
    EXPECT_EQ(read.views[v].edge_distance, index->views[v].edge_distance);
    EXPECT_EQ(read.views[v].outward, index->views[v].outward);
  }
}

TEST(ModelFile, IndexOfAnotherVersionIsComputedAgain) {
  const ModelSource model = some_model("a", 1);
  const auto made = make_object_model(model);
  ASSERT_TRUE(made.ok());
  std::string bytes = index_bytes(*(*made)->index, model.normal_variance);
  ASSERT_TRUE(parse_index(bytes, model.surface.size(), "x").ok());
  bytes[8] = static_cast<char>(bytes[8] + 1);  // the version, after "bpaindex"
  const auto other = parse_index(bytes, model.surface.size(), "x");
  ASSERT_TRUE(other.ok()) << other.status().message;
  EXPECT_EQ(other->index, nullptr);
  EXPECT_EQ(other->normal_variance, model.normal_variance);
}

// A file whose checksum was made to fit must not make anything read outside an array either.
TEST(ModelFile, NoIndexLeavesItsArrays) {
  const ModelSource model = some_model("a", 1);
  const auto made = make_object_model(model);
  ASSERT_TRUE(made.ok());
  const std::string bytes = index_bytes(*(*made)->index, model.normal_variance);
  EXPECT_FALSE(parse_index(bytes, model.surface.size() - 1, "x").ok());
  EXPECT_FALSE(parse_index(bytes + "x", model.surface.size(), "x").ok());
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 7) {
    EXPECT_FALSE(parse_index(bytes.substr(0, size), model.surface.size(), "x").ok()) << size;
  }
  for (std::size_t at = 12; at + 8 < bytes.size(); at += 1 + at / 50) {
    std::string damaged = bytes;
    damaged.replace(at, 8, 8, '\xff');
    const auto file = parse_index(damaged, model.surface.size(), "x");  // must not crash
    if (file.ok() && file->index) {
      for (const std::uint32_t i : file->index->distances.nearest) {
        ASSERT_LT(i, model.surface.size());
      }
    }
  }
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
  newer.replace(newer.find("\"version\": 2"), 12, "\"version\": 3");
  spill(folder / "a/model.json", newer);
  EXPECT_NE(message().find("version 3"), std::string::npos);
  spill(folder / "a/model.json", json);
  const std::string index = slurp(folder / "a/index.bin");
  spill(folder / "a/index.bin", index.substr(0, 100));
  EXPECT_NE(message().find("index.bin is truncated"), std::string::npos);
  altered = index;
  altered[200] = static_cast<char>(altered[200] ^ 1);
  spill(folder / "a/index.bin", altered);
  EXPECT_NE(message().find("index.bin was altered"), std::string::npos);
}

TEST(ModelFile, OneBrokenModelCostsNoOther) {
  const test::TemporaryFolder folder;
  for (int k = 0; k < 4; ++k) {
    const std::string name(1, static_cast<char>('a' + k));
    ASSERT_TRUE(save_model(folder.path(), some_model(name, 9 - k)).ok());
  }
  EXPECT_TRUE(explain_broken(folder.path(), read_library(folder.path())->broken).ok());
  spill(folder / "b/surface.ply", slurp(folder / "b/surface.ply").substr(0, 60));
  spill(folder / "d/model.json", slurp(folder / "a/model.json"));  // another's name
  std::string json = slurp(folder / "c/model.json");
  json.replace(json.find("\"number\": 7"), 11, "\"number\": 9");  // that of a
  spill(folder / "c/model.json", json);
  const auto contents = read_library(folder.path());
  ASSERT_TRUE(contents.ok()) << contents.status().message;
  ASSERT_EQ(contents->models.size(), 1u);
  EXPECT_EQ(contents->models[0].name, "a");
  ASSERT_EQ(contents->broken.size(), 3u);
  EXPECT_EQ(contents->broken[0].name, "b");
  const std::string why = explain_broken(folder.path(), contents->broken).message;
  for (const char* words : {"3 models", "b (", "truncated", "a and c have the same number 9",
                            "names the model \"a\"; its folder must too"}) {
    EXPECT_NE(why.find(words), std::string::npos) << words << " in " << why;
  }
  EXPECT_EQ(load_library(folder.path()).status().code, StatusCode::corrupt);
  EXPECT_EQ(read_library(folder / "none").status().code, StatusCode::not_found);
}

// The definition of the checksum, bit by bit.
TEST(FileBytes, ChecksumIsThatOfPngAndZip) {
  EXPECT_EQ(crc32("123456789"), 0xcbf43926u);  // the check value of the standard
  std::string bytes;
  for (int i = 0; i < 40; ++i) {
    std::uint32_t crc = 0xffffffffu;
    for (const char byte : bytes) {
      crc ^= static_cast<std::uint8_t>(byte);
      for (int k = 0; k < 8; ++k) crc = (crc & 1) ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
    }
    EXPECT_EQ(crc32(bytes), ~crc) << i;
    bytes += static_cast<char>(37 * i + 200);
  }
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
