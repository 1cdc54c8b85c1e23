// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/model_file.hpp"

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/private/model_parts.hpp"
#include "core/model/model_index.hpp"
#include "core/model/occupancy_grid.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/temporary_folder.hpp"

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

/// Such as that of a mesh whose name is Latin-1.
TEST(ModelFile, SourceInAnyEncoding) {
  const test::TemporaryFolder folder;
  ModelSource model = some_model("cup", 1);
  model.source = "caf\xe9.obj";
  ASSERT_TRUE(save_model(folder.path(), model, 1).ok());
  EXPECT_EQ(load_model(folder.path(), "cup")->source, "caf\xef\xbf\xbd.obj");
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
  EXPECT_EQ(back->noise.normal(0.003, 1.1), model.noise.normal(0.003, 1.1));
  EXPECT_TRUE(back->noise.fitted);
  EXPECT_EQ(back->warnings, model.warnings);
}

void expect_same(const ModelView& a, const ModelView& b) {
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.visible, b.visible);
  EXPECT_EQ(a.edge_distance, b.edge_distance);
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_EQ(a.outward, b.outward);
}

// What detection reads from the file is what it would compute from the surface.
TEST(ModelFile, StoredIndexIsTheComputedOne) {
  const test::TemporaryFolder folder;
  const auto source = modeling::model_source_from_mesh(test::l_mesh(), "l", 1);
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
    expect_same(read.views[v], index->views[v]);
  }
}

void expect_same(const PointCloud& a, const PointCloud& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.curvatures, b.curvatures);
  EXPECT_EQ(a.principal_directions, b.principal_directions);
}

void expect_same(const features::PointPairTable::Arrays& a,
                 const features::PointPairTable::Arrays& b) {
  EXPECT_EQ(a.inverse_step, b.inverse_step);
  EXPECT_EQ(a.max_distance, b.max_distance);
  EXPECT_EQ(a.first, b.first);
  EXPECT_EQ(a.entries, b.entries);
}

// A model with everything that a file of an index holds: colours, near symmetries and flat rests.
ModelSource coloured_brick() {
  ModelSource source =
      *modeling::model_source_from_mesh(test::box_mesh({0.06f, 0.04f, 0.02f}), "brick", 1);
  for (std::size_t i = 0; i < source.surface.size(); ++i) {
    source.surface.colors.push_back({static_cast<std::uint8_t>(i % 251), 80, 200});
  }
  return source;
}

TEST(ModelFile, MappedIndexIsTheBuiltOneFieldByField) {
  const test::TemporaryFolder folder;
  const ModelSource source = coloured_brick();
  const auto made = make_object_model(source);
  ASSERT_TRUE(made.ok());
  ASSERT_TRUE(save_model(folder.path(), source).ok());
  const auto stored = load_model(folder.path(), "brick");
  ASSERT_TRUE(stored.ok()) << stored.status().message;
  ASSERT_TRUE(remove_model(folder.path(), "brick").ok()) << "what was loaded stays";
  const ModelIndex &read = *stored->prepared, &built = *(*made)->index;
  ASSERT_FALSE(built.near_symmetries.empty());
  ASSERT_FALSE(built.flat_rests.empty());
  ASSERT_FALSE(built.pairs.arrays().entries.empty());
  ASSERT_FALSE(built.rim_pairs.arrays().entries.empty());
  EXPECT_EQ(read.soft_normals, built.soft_normals);
  EXPECT_EQ(read.check.points, built.check.points);
  EXPECT_EQ(read.check.surface, built.check.surface);
  EXPECT_EQ(read.fpfh, built.fpfh);
  EXPECT_EQ(read.cielab, built.cielab);
  EXPECT_EQ(read.log_light, built.log_light);
  EXPECT_EQ(read.point_area, built.point_area);
  EXPECT_EQ(read.distances.low, built.distances.low);
  EXPECT_EQ(read.distances.cell, built.distances.cell);
  EXPECT_EQ(read.distances.size, built.distances.size);
  EXPECT_EQ(read.distances.nearest, built.distances.nearest);
  expect_same(read.features, built.features);
  expect_same(read.coarse, built.coarse);
  expect_same(read.pairs.arrays(), built.pairs.arrays());
  expect_same(read.rim_pairs.arrays(), built.rim_pairs.arrays());
  ASSERT_EQ(read.views.size(), built.views.size());
  for (std::size_t v = 0; v < read.views.size(); ++v) expect_same(read.views[v], built.views[v]);
  ASSERT_EQ(read.near_symmetries.size(), built.near_symmetries.size());
  for (std::size_t k = 0; k < read.near_symmetries.size(); ++k) {
    const Pose &a = read.near_symmetries[k], &b = built.near_symmetries[k];
    EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
    EXPECT_EQ(a.translation, b.translation);
  }
  ASSERT_EQ(read.flat_rests.size(), built.flat_rests.size());
  for (std::size_t k = 0; k < read.flat_rests.size(); ++k) {
    const FlatRest &a = read.flat_rests[k], &b = built.flat_rests[k];
    EXPECT_EQ(a.up, b.up);
    EXPECT_EQ(a.axis, b.axis);
    EXPECT_EQ(a.centre, b.centre);
    EXPECT_EQ(a.length, b.length);
    EXPECT_EQ(a.width, b.width);
  }
  EXPECT_EQ(read.feature_tree.nearest(built.fpfh, 1, 1).front().index, 0);
  // What was read is written as it was.
  EXPECT_EQ(index_bytes(read, source.normal_variance), index_bytes(built, source.normal_variance));
}

TEST(ModelFile, IndexOfAnotherVersionIsComputedAgain) {
  const ModelSource model = some_model("a", 1);
  const auto made = make_object_model(model);
  ASSERT_TRUE(made.ok());
  std::string bytes = index_bytes(*(*made)->index, model.normal_variance);
  ASSERT_TRUE(parse_index({bytes, nullptr}, model.surface.size(), "x").ok());
  bytes[8] = static_cast<char>(bytes[8] + 1);  // the version, after "bpaindex"
  const auto other = parse_index({bytes, nullptr}, model.surface.size(), "x");
  ASSERT_TRUE(other.ok()) << other.status().message;
  EXPECT_EQ(other->index, nullptr);
  EXPECT_EQ(other->normal_variance, model.normal_variance);
}

void expect_below(const SharedArray<std::uint32_t>& indices, std::size_t limit) {
  EXPECT_TRUE(std::ranges::all_of(indices, [limit](std::uint32_t i) { return i < limit; }));
}

// Every index that detection may meet is one of its array.
void expect_inside(const ModelIndex& index, std::size_t points) {
  expect_below(index.distances.nearest, points);
  EXPECT_EQ(index.distances.nearest.size(), index.distances.size.prod());
  for (const ModelView& view : index.views) {
    expect_below(view.visible, points);
    expect_below(view.edges, points);
    EXPECT_EQ(view.edge_distance.size(), view.visible.size());
    EXPECT_EQ(view.outward.size(), view.edges.size());
  }
  for (const features::PointPairTable* table : {&index.pairs, &index.rim_pairs}) {
    for (float distance = 0; distance < 0.1f; distance += 0.003f) {
      for (std::uint16_t key = 0; key < features::PointPairTable::kAngleKeys; ++key) {
        for (const auto& entry : table->lookup(distance, key)) {
          ASSERT_LT(entry.point, index.coarse.size());
        }
      }
    }
    (void)table->lookup(table->max_distance(), 0);
  }
}

// A file whose checksum was made to fit must not make anything read outside an array either.
TEST(ModelFile, NoIndexLeavesItsArrays) {
  const ModelSource model = coloured_brick();
  const auto made = make_object_model(model);
  ASSERT_TRUE(made.ok());
  const std::size_t points = model.surface.size();
  const std::string bytes = index_bytes(*(*made)->index, model.normal_variance);
  const auto parse = [points](const std::string& text, std::size_t skipped = 0) {
    return parse_index({std::string_view(text).substr(skipped), nullptr}, points, "x");
  };
  EXPECT_FALSE(parse_index({bytes, nullptr}, points - 1, "x").ok());
  EXPECT_FALSE(parse(bytes + "x").ok());
  EXPECT_FALSE(parse("x" + bytes, 1).ok()) << "no array is where it may be read";
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 7) {
    EXPECT_FALSE(parse(bytes.substr(0, size)).ok()) << size;
  }
  for (std::size_t at = 12; at + 8 < bytes.size(); at += 1 + at / 50) {
    for (const char value : {'\xff', '\x7f', '\x01'}) {
      std::string damaged = bytes;
      damaged.replace(at, 8, 8, value);
      const auto file = parse(damaged);  // must not crash
      if (file.ok() && file->index) expect_inside(*file->index, points);
    }
  }
}

// A grid of 5 x 40 x 7 cells with one bucket, the other or both in each.
OccupancyGrid some_grid() {
  OccupancyGrid grid;
  grid.low = {-0.1f, 0.02f, 0.3f};
  grid.cell = 0.003f;
  grid.size = {5, 40, 7};
  RandomStream random(3);
  const auto share = [&random] { return static_cast<float>(random.uniform()); };
  for (int k = 0; k < 300; ++k) {
    OccupancyCell cell;
    cell.place = {random.index(5), random.index(40), random.index(7)};
    for (std::size_t b = 0; b < 2; ++b) {
      if (k % 3 == static_cast<int>(b)) continue;
      ViewBucket& bucket = cell.buckets[b];
      bucket.rays = 1 + random.index(70000);
      bucket.occupancy = k == 5 ? 0.5f : share();
      bucket.position = grid.low + grid.cell * (cell.place.cast<float>() +
                                                Eigen::Vector3f(share(), share(), share()));
      bucket.normal = Eigen::Vector3f(share() - 0.5f, share() - 0.5f, share() - 0.5f).normalized();
      bucket.normal_variance = share();
    }
    grid.cells.push_back(cell);
  }
  return grid;
}

TEST(ModelFile, OccupancyGridIsPartOfIt) {
  const test::TemporaryFolder folder;
  ModelSource model = some_model("a", 1);
  ASSERT_TRUE(save_model(folder.path(), model).ok());
  const auto none = load_occupancy(folder.path(), "a");
  ASSERT_TRUE(none.ok()) << none.status().message;
  EXPECT_EQ(*none, nullptr);
  const OccupancyGrid grid = some_grid();
  model.occupancy = std::make_shared<OccupancyGrid>(grid);
  ASSERT_TRUE(save_model(folder.path(), model).ok());
  EXPECT_EQ(load_model(folder.path(), "a")->occupancy, nullptr) << "detection does not need it";
  const auto read = load_occupancy(folder.path(), "a");
  ASSERT_TRUE(read.ok()) << read.status().message;
  const OccupancyGrid& back = **read;
  EXPECT_EQ(back.low, grid.low);
  EXPECT_EQ(back.cell, grid.cell);
  EXPECT_EQ(back.size, grid.size);
  ASSERT_EQ(back.cells.size(), grid.cells.size());
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    EXPECT_EQ(back.cells[i].place, grid.cells[i].place);
    for (std::size_t b = 0; b < 2; ++b) {
      const ViewBucket &is = back.cells[i].buckets[b], &was = grid.cells[i].buckets[b];
      EXPECT_EQ(is.rays, was.rays);
      EXPECT_EQ(occupied(is), occupied(was));
      EXPECT_NEAR(is.occupancy, was.occupancy, 1e-5f);
      EXPECT_LT((is.position - was.position).norm(), 1e-7f);
      EXPECT_LT((is.normal - was.normal).norm(), 1e-4f);
      EXPECT_NEAR(is.normal_variance, was.normal_variance, 2e-4f);
    }
  }
}

TEST(ModelFile, DamageOfTheOccupancyGridIsSaid) {
  const test::TemporaryFolder folder;
  ModelSource model = some_model("a", 1);
  model.occupancy = std::make_shared<OccupancyGrid>(some_grid());
  ASSERT_TRUE(save_model(folder.path(), model).ok());
  const std::string bytes = slurp(folder / "a/occupancy.bin");
  const auto expect_refused = [&](const std::string& words) {
    for (const Status& status :
         {load_model(folder.path(), "a").status(), load_occupancy(folder.path(), "a").status()}) {
      EXPECT_EQ(status.code, StatusCode::corrupt);
      EXPECT_NE(status.message.find(words), std::string::npos) << status.message;
    }
  };
  spill(folder / "a/occupancy.bin", bytes.substr(0, bytes.size() / 2));
  expect_refused("occupancy.bin is truncated");
  std::string altered = bytes;
  altered[bytes.size() / 3] = static_cast<char>(altered[bytes.size() / 3] ^ 4);
  spill(folder / "a/occupancy.bin", altered);
  expect_refused("occupancy.bin was altered");
  std::filesystem::remove(folder / "a/occupancy.bin");
  EXPECT_FALSE(load_model(folder.path(), "a").ok());
  EXPECT_FALSE(load_occupancy(folder.path(), "a").ok());
}

// A file whose checksum was made to fit must not give cells that are not in the grid either.
TEST(ModelFile, NoOccupancyGridLeavesItself) {
  const auto written = occupancy_bytes(some_grid());
  ASSERT_TRUE(written.ok());
  const std::string& bytes = *written;
  ASSERT_TRUE(parse_occupancy(bytes, "x").ok());
  EXPECT_FALSE(parse_occupancy(bytes + "x", "x").ok());
  std::string other = bytes;
  other[8] = static_cast<char>(other[8] + 1);  // the version, after "bpaoccup"
  EXPECT_NE(parse_occupancy(other, "x").status().message.find("version 2"), std::string::npos);
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 20) {
    EXPECT_FALSE(parse_occupancy(bytes.substr(0, size), "x").ok()) << size;
  }
  for (std::size_t at = 12; at + 8 < bytes.size(); at += 1 + at / 100) {
    std::string damaged = bytes;
    damaged.replace(at, 8, 8, '\xff');
    const auto grid = parse_occupancy(damaged, "x");  // must not crash
    if (!grid.ok()) continue;
    for (const OccupancyCell& cell : grid->cells) {
      ASSERT_TRUE((cell.place.array() < grid->size.array()).all());
      ASSERT_GE(cell.buckets[0].rays, 0);
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
  newer.replace(newer.find("\"version\": 4"), 12, "\"version\": 3");
  spill(folder / "a/model.json", newer);
  EXPECT_NE(message().find("has format version 3; this program reads version 4: make the model "
                           "again (bpa model from-mesh"),
            std::string::npos);
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

// Of the specification and of the program xxhsum.
TEST(FileBytes, HashIsXxh64) {
  EXPECT_EQ(xxh64(""), 0xef46db3751d8e999u);
  EXPECT_EQ(xxh64("a"), 0xd24ec4f1a98c6e5bu);
  EXPECT_EQ(xxh64("abc"), 0x44bc2cf5ad770999u);
  EXPECT_EQ(xxh64("Nobody inspects the spammish repetition"), 0xfbcea83c8a378bf1u);
}

TEST(FileBytes, HashDiffersWhereverABitIs) {
  std::string bytes(77, 'b');  // every kind of step: stripes of 32, 8, 4 and 1 byte
  const std::uint64_t hash = xxh64(bytes);
  for (char& byte : bytes) {
    for (int bit = 0; bit < 8; ++bit) {
      byte = static_cast<char>(byte ^ 1 << bit);
      EXPECT_NE(xxh64(bytes), hash);
      byte = static_cast<char>(byte ^ 1 << bit);
    }
  }
}

TEST(FileBytes, MappedBytesAreThoseOfTheFile) {
  const test::TemporaryFolder folder;
  for (const std::size_t size : {0, 1, 4096, 70001}) {
    std::string bytes(size, 'x');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * i);
    spill(folder / "file", bytes);
    const auto mapped = map_file(folder / "file");
    ASSERT_TRUE(mapped.ok()) << mapped.status().message;
    std::filesystem::remove(folder / "file");
    EXPECT_EQ(mapped->bytes, bytes);
  }
  EXPECT_EQ(map_file(folder / "none").status().code, StatusCode::not_found);
  EXPECT_EQ(map_file(folder.path()).status().code, StatusCode::invalid_argument);
}

TEST(ModelFile, EmptyAndMissingLibraries) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(load_library(folder.path()).status().code, StatusCode::invalid_argument);
  EXPECT_EQ(load_library(folder / "none").status().code, StatusCode::not_found);
  EXPECT_EQ(load_model(folder.path(), "../x").status().code, StatusCode::not_found);
  const std::string too_long(5000, 'x');  // as a path: no system call takes it
  EXPECT_EQ(load_model(too_long, "x").status().code, StatusCode::unavailable);
  EXPECT_EQ(save_model(folder.path(), some_model("../x", 1)).code, StatusCode::invalid_argument);
  EXPECT_EQ(save_model(folder.path(), some_model("x", 0)).code, StatusCode::invalid_argument);
  EXPECT_EQ(clean_model_name("a b/c"), "a_b_c");
  EXPECT_EQ(clean_model_name("..x"), "_..x");
}

}  // namespace
}  // namespace bpa::io
