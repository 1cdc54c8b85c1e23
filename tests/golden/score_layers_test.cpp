// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// tests/accuracy/train.sh on few scenes makes the same layers again. score_layers.json holds them
// as this test writes them with BPA_WRITE_GOLDEN=1 in the environment.
#include <cmath>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.hpp"

namespace bpa {
namespace {

using Json = nlohmann::json;

constexpr const char* kGolden = BPA_SOURCE_DIR "/tests/golden/score_layers.json";

// Embree picks its instructions by the processor, unless the home folder says otherwise.
std::string train(const test::TemporaryFolder& folder) {
  test::spill(folder / ".embree3", "isa=sse2\n");
  const std::string command = "HOME=" + (folder / "") +
                              " BPA_SCENES=2 BPA_OBJECTS=milk_carton,bowl,bottle " +
                              BPA_SOURCE_DIR "/tests/accuracy/train.sh " BPA_BINARY_DIR "/bin " +
                              (folder / "made") + " >" + (folder / "log") + " 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << command << "\n" << test::slurp(folder / "log");
  return folder / "made/score_layers.json";
}

void expect_near(const Json& made, const Json& golden, const std::string& name) {
  ASSERT_EQ(made.type(), golden.type()) << name;
  if (golden.is_number_float()) {
    EXPECT_NEAR(made, golden, 1e-6 * std::max(1.0, std::abs(golden.get<double>()))) << name;
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
  const std::string made = test::slurp(train(folder));
  if (std::getenv("BPA_WRITE_GOLDEN")) test::spill(kGolden, made);
  expect_near(Json::parse(made), Json::parse(test::slurp(kGolden)), "");
}

// What train.sh writes as the provenance with its own number of scenes.
TEST(GoldenScoreLayers, BuiltInOnesAreMadeByTheSameCommand) {
  const Json built_in = Json::parse(test::slurp(BPA_SOURCE_DIR "/config/score_layers.json"));
  const Json small = Json::parse(test::slurp(kGolden));
  for (const char* layer : {"round_two", "round_three", "without_color"}) {
    const std::string provenance = built_in.at(layer).at("provenance");
    EXPECT_EQ(provenance.rfind("tests/accuracy/train.sh, up to 400 scenes of each data set: ", 0),
              0U)
        << layer << ": " << provenance;
    for (const auto& [name, component] : small.at(layer).at("components").items()) {
      EXPECT_TRUE(built_in.at(layer).at("components").contains(name)) << layer << "." << name;
    }
  }
}

}  // namespace
}  // namespace bpa
