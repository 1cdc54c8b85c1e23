// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa train on few frames makes the same layers again. score_layers.json holds them as this test
// writes them with BPA_WRITE_GOLDEN=1 in the environment. The frames are of tests/support: Embree,
// which bpa simulate renders with, approximates reciprocals otherwise on AMD than on Intel.
#include <array>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/io/bop_dataset.hpp"
#include "tests/support/posed_models.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa {
namespace {

using Json = nlohmann::json;
using Rgb = std::array<std::uint8_t, 3>;

constexpr const char* kGolden = BPA_SOURCE_DIR "/tests/golden/score_layers.json";
constexpr Rgb kGrey{130, 130, 130}, kRed{170, 60, 50}, kBlue{50, 80, 160}, kGreen{70, 140, 60};
constexpr int kL = 1, kBrick = 2;

struct PaintedScene {
  std::vector<test::Solid> solids;
  std::vector<Rgb> colors;
  std::vector<io::BopInstanceRecord> truth;

  void add(const test::Solid& solid, const Rgb& color) {
    solids.push_back(solid);
    colors.push_back(color);
  }
  void add_object(int obj_id, const Pose& camera_from_object) {
    io::BopInstanceRecord& added = truth.emplace_back();
    added.obj_id = obj_id;
    added.camera_from_object = camera_from_object;
  }
};

// An object of the library, or one that resembles it, in each of six places on a table.
PaintedScene random_scene(RandomStream& random) {
  const Pose camera_from_world =
      test::look_at({random.uniform(-0.4, 0.4), -0.6, random.uniform(0.4, 0.7)}, {0, 0, 0});
  PaintedScene scene;
  scene.add(test::table(camera_from_world), kGrey);
  for (int place = 0; place < 6; ++place) {
    const double x = 0.2 * (place % 3 - 1) + random.uniform(-0.02, 0.02);
    const double y = 0.24 * (place % 2) - 0.12 + random.uniform(-0.02, 0.02);
    const double angle = random.uniform(0, 2 * M_PI);
    const auto standing = [&](double z) {
      return camera_from_world * test::standing_at(x, y, z, angle);
    };
    const Pose brick = standing(test::kBrickHalf.cast<double>().z());
    switch (random.index(7)) {
      case 0:
      case 1: {
        const auto parts = test::l_solids(standing(0.02));
        scene.add(parts[0], kRed);
        scene.add(parts[1], kBlue);
        scene.add_object(kL, standing(0.02));
        break;
      }
      case 2:
      case 3:
        scene.add(test::brick_solid(brick), kGreen);
        scene.add_object(kBrick, brick);
        break;
      case 4:
        scene.add(test::brick_solid(brick), kBlue);
        break;
      case 5:
        scene.add({test::Solid::Kind::box, {0.07, 0.035, 0.02}, standing(0.02)}, kRed);
        break;
      default:
        scene.add({test::Solid::Kind::cylinder, {0.04, 0, 0.03}, standing(0.03)}, kGreen);
    }
  }
  return scene;
}

Frame photograph(const PaintedScene& scene, RandomStream& random) {
  auto image = test::render(scene.solids, test::kinect_camera(), 1, random());
  for (const int solid : image.solid) {
    const int noise = random.index(17) - 8;
    for (const int channel : solid < 0 ? Rgb{} : scene.colors[static_cast<std::size_t>(solid)]) {
      image.frame.color.push_back(static_cast<std::uint8_t>(std::max(0, channel + noise)));
    }
  }
  return std::move(image.frame);
}

void write_frames(const std::string& dataset, std::uint64_t seed, int count) {
  io::BopSceneWriter writer(dataset, "test", 1, 0.1);
  for (int i = 0; i < count; ++i) {
    RandomStream random(seed, static_cast<std::uint64_t>(i));
    const PaintedScene scene = random_scene(random);
    ASSERT_TRUE(writer.add(i, photograph(scene, random), scene.truth).ok());
  }
  ASSERT_TRUE(writer.finish().ok());
}

io::BopMesh painted_model(int obj_id, const std::string& name, TriangleMesh mesh,
                          const std::vector<Rgb>& of_boxes, const SymmetryGroup& symmetry) {
  constexpr std::size_t kOfABox = 24;  // vertices
  double diameter = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    mesh.colors.push_back(of_boxes[i / kOfABox]);
    for (const auto& other : mesh.vertices) {
      diameter = std::max<double>(diameter, (mesh.vertices[i] - other).norm());
    }
  }
  return {obj_id, name, diameter, symmetry, std::move(mesh)};
}

void run(const std::string& command, const std::string& log) {
  const std::string all = command + " >" + log + " 2>&1";
  ASSERT_EQ(std::system(all.c_str()), 0) << all << "\n" << test::slurp(log);
}

// Processors round differently: between an AMD EPYC and an Intel Xeon with AVX-512, layers differ
// by up to 1e-4 and limits by up to 1e-3.
constexpr double kRounding = 0.01;

void expect_near(const Json& made, const Json& golden, const std::string& name) {
  ASSERT_EQ(made.type(), golden.type()) << name;
  if (golden.is_number_float()) {
    EXPECT_NEAR(made, golden, kRounding * std::max(1.0, std::abs(golden.get<double>()))) << name;
  } else if (golden.is_structured()) {
    ASSERT_EQ(made.size(), golden.size()) << name;
    auto other = made.begin();
    for (auto it = golden.begin(); it != golden.end(); ++it, ++other) {
      if (golden.is_object()) {
        ASSERT_EQ(other.key(), it.key()) << name;
      }
      expect_near(*other, *it, name + (golden.is_object() ? "." + it.key() : ""));
    }
  } else {
    EXPECT_EQ(made, golden) << name;
  }
}

TEST(GoldenScoreLayers, TrainingMakesTheSameLayersAgain) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(io::write_bop_models(folder / "set",
                                   {painted_model(kL, "l", test::l_mesh(), {kRed, kBlue}, {}),
                                    painted_model(kBrick, "brick", test::box_mesh(test::kBrickHalf),
                                                  {kGreen}, test::brick_symmetry())})
                  .ok());
  write_frames(folder / "set", 1, 10);
  write_frames(folder / "in_use", 2, 14);
  const std::string bpa = BPA_BINARY_DIR "/bin/bpa ";
  const std::string library = " --library " + (folder / "library");
  run(bpa + "model from-bop " + (folder / "set") + library, folder / "log");
  run(bpa + "train --held-out 0 --bop " + (folder / "set") + " --calibration-bop " +
          (folder / "in_use") + library + " --output " + (folder / "made.json"),
      folder / "log");
  const std::string made = test::slurp(folder / "made.json");
  if (std::getenv("BPA_WRITE_GOLDEN")) test::spill(kGolden, made);
  expect_near(Json::parse(made), Json::parse(test::slurp(kGolden)), "");
}

// The sets that a layer is made of, whatever the number of scenes.
std::string without_numbers(const std::string& provenance) {
  static const std::regex number("[0-9]+");
  return std::regex_replace(provenance.substr(0, provenance.find(" frames")), number, "N");
}

// Not the numbers of layers: they depend on Embree's.
TEST(GoldenScoreLayers, BuiltInOnesAreMadeOfTheSetsOfTrainSh) {
  const test::TemporaryFolder folder;
  run("BPA_SCENES=2 BPA_OBJECTS=milk_carton,bowl,bottle " BPA_SOURCE_DIR
      "/tests/accuracy/train.sh " BPA_BINARY_DIR "/bin " +
          (folder / "made"),
      folder / "log");
  const Json made = Json::parse(test::slurp(folder / "made/score_layers.json"));
  const Json built_in = Json::parse(test::slurp(BPA_SOURCE_DIR "/config/score_layers.json"));
  for (const char* layer : {"round_two", "round_three", "without_color"}) {
    EXPECT_EQ(without_numbers(made.at(layer).at("provenance")),
              without_numbers(built_in.at(layer).at("provenance")));
    const Json& components = made.at(layer).at("components");
    EXPECT_EQ(components.size(), built_in.at(layer).at("components").size()) << layer;
    for (const auto& [name, component] : components.items()) {
      EXPECT_TRUE(built_in.at(layer).at("components").contains(name)) << layer << "." << name;
      for (const Json& value : component.at("log_odds")) {
        EXPECT_TRUE(value.is_number()) << layer << "." << name;  // what is not finite is null
      }
    }
  }
}

}  // namespace
}  // namespace bpa
