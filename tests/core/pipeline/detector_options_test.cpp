// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/detector_options.hpp"

#include <algorithm>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "core/io/options_yaml.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa {
namespace {

class DetectorOptionsFile : public ::testing::Test {
 protected:
  Result<DetectorOptions> load(const std::string& text) const {
    test::spill(path(), text);
    return load_detector_options(path());
  }
  // What is said after "FILE:LINE: ".
  std::string refusal(const std::string& text, int line) const {
    const auto options = load(text);
    EXPECT_EQ(options.status().code, StatusCode::invalid_argument) << text;
    const std::string place = path() + ":" + std::to_string(line) + ": ";
    const std::string& message = options.status().message;
    EXPECT_EQ(message.substr(0, place.size()), place);
    return message.size() > place.size() ? message.substr(place.size()) : "";
  }
  std::string path() const { return folder_ / "detector.yaml"; }

 private:
  test::TemporaryFolder folder_;
};

// Every field as text.
std::string values(DetectorOptions options) { return io::options_yaml(options_of(options)); }

TEST_F(DetectorOptionsFile, OverridesOnlyWhatItNames) {
  const auto options = load(
      "surface:\n  max_range_m: 1.5\nfeatures: {max_keypoints: 700}\nround_two: {bpa_steps: 2}\n"
      "planes:\n  label_planes: false\n");
  ASSERT_TRUE(options.ok()) << options.status().message;
  DetectorOptions expected;
  expected.surface.max_range_m = 1.5;
  expected.features.max_keypoints = 700;
  expected.detect.round_two.bpa_steps = 2;
  expected.planes.label_planes = false;
  EXPECT_EQ(values(*options), values(expected));
}

TEST_F(DetectorOptionsFile, AFieldMayBeNamedWithoutItsGroupIfOnlyOneHasTheName) {
  const auto options = load("max_keypoints: 700\nuse_orientation: false\n");
  ASSERT_TRUE(options.ok()) << options.status().message;
  EXPECT_EQ(options->features.max_keypoints, 700);
  EXPECT_FALSE(options->detect.align.use_orientation);
  EXPECT_EQ(refusal("max_in_library: 1\n", 1),
            "unknown key max_in_library; there is check.max_in_library or cluster.max_in_library "
            "or round_two.max_in_library");
}

TEST_F(DetectorOptionsFile, EmptyFilesChangeNothing) {
  for (const char* text : {"", "\n\n", "# only a comment\n", "---\n", "{}\n"}) {
    const auto options = load(text);
    ASSERT_TRUE(options.ok()) << options.status().message;
    EXPECT_EQ(values(*options), values({}));
  }
}

TEST_F(DetectorOptionsFile, UnknownKeyIsNamedWithItsPlace) {
  EXPECT_EQ(refusal("max_range_m: 2\n\nmax_rang_m: 3\n", 3),
            "unknown key max_rang_m; the nearest is surface.max_range_m");
  EXPECT_EQ(refusal("planes:\n  lable_plane: false\n", 2),
            "unknown key planes.lable_plane; the nearest is planes.label_planes");
  const std::string said = refusal("colour: true\n", 1);
  EXPECT_EQ(said.find("unknown key colour; the keys are surface, planes, features"), 0u) << said;
}

TEST_F(DetectorOptionsFile, WrongKindIsNamedWithItsPlace) {
  EXPECT_EQ(refusal("max_range_m: far\n", 1), "surface.max_range_m is far; it must be a number");
  EXPECT_EQ(refusal("max_range_m:\n", 1), "surface.max_range_m is ~; it must be a number");
  EXPECT_EQ(refusal("# hello\nmax_keypoints: 3.5\n", 2),
            "features.max_keypoints is 3.5; it must be a whole number");
  EXPECT_EQ(refusal("max_keypoints: [1, 2]\n", 1),
            "features.max_keypoints is [1, 2]; it must be a whole number");
  EXPECT_EQ(refusal("label_planes: 7\n", 1), "planes.label_planes is 7; it must be true or false");
}

TEST_F(DetectorOptionsFile, ValueOutOfRangeIsNamedWithItsPlaceAndTheRule) {
  EXPECT_EQ(refusal("max_keypoints: 500\nmax_range_m: 50\n", 2),
            "surface.max_range_m is 50; it must be between 0.2 and 20");
  EXPECT_EQ(refusal("max_range_m: .nan\n", 1),
            "surface.max_range_m is nan; it must be between 0.2 and 20");
  EXPECT_EQ(refusal("max_keypoints: -1\n", 1),
            "features.max_keypoints is -1; it must be between 10 and 100000");
}

TEST_F(DetectorOptionsFile, WhatIsNoMapIsRefused) {
  EXPECT_NE(refusal("- max_range_m\n", 1).find("key: value"), std::string::npos);
  EXPECT_NE(refusal("just words\n", 1).find("key: value"), std::string::npos);
  EXPECT_NE(refusal("[1, 2]: 3\n", 1).find("key: value"), std::string::npos);
}

TEST_F(DetectorOptionsFile, WhatIsNoYamlIsRefused) {
  refusal("max_range_m: 2\nmax_keypoints: [1, 2\n", 3);
  EXPECT_FALSE(load("a: *nobody\n").ok());
}

TEST_F(DetectorOptionsFile, MissingFileIsNotFound) {
  const auto options = load_detector_options(path() + ".not");
  EXPECT_EQ(options.status().code, StatusCode::not_found);
  EXPECT_EQ(options.status().message, path() + ".not: there is no such file");
}

TEST(DetectorPresets, ThePaperHasOneRoundOfMatchesWithoutColours) {
  const auto options = load_detector_options(BPA_SOURCE_DIR "/config/presets/paper.yaml");
  ASSERT_TRUE(options.ok()) << options.status().message;
  EXPECT_EQ(options->rounds.max_rounds, 1);
  EXPECT_EQ(options->features.max_references, 0);
  EXPECT_FALSE(options->features.use_color);
  EXPECT_EQ(options->detect.check.points, 500);
}

// The lines of config/detector.yaml below its heading.
std::string documented() {
  DetectorOptions defaults;
  return io::options_yaml(options_of(defaults), true);
}

std::string config_file() { return test::slurp(BPA_SOURCE_DIR "/config/detector.yaml"); }

TEST(DetectorYaml, ShowsEveryKeyWithItsDefault) {
  const std::string text = config_file();
  const std::string expected = documented();
  EXPECT_EQ(text.substr(text.size() - std::min(text.size(), expected.size())), expected)
      << "the end of config/detector.yaml is to read as the right-hand side does";
}

TEST(DetectorYaml, ChangesNothingAsItIsAndWithEveryKeyInForce) {
  std::string text = config_file();
  test::TemporaryFolder folder;
  test::spill(folder / "a.yaml", text);
  for (std::size_t at = text.find('#'); at != std::string::npos; at = text.find('#', at + 1)) {
    if (text[at + 1] != ' ') text.erase(at, 1);
  }
  test::spill(folder / "b.yaml", text);
  for (const char* name : {"a.yaml", "b.yaml"}) {
    const auto options = load_detector_options(folder / name);
    ASSERT_TRUE(options.ok()) << options.status().message;
    EXPECT_EQ(values(*options), values({}));
  }
}

TEST(DetectorOptions, DefaultsKeepTheirOwnRules) { EXPECT_TRUE(validate(DetectorOptions{}).ok()); }

}  // namespace
}  // namespace bpa
