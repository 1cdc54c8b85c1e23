// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/pipeline/detector.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa {
namespace {

class ScoreLayerFile : public ::testing::Test {
 protected:
  std::string refusal() const {
    const auto read = library_score_layers(folder_.path());
    EXPECT_FALSE(read.ok());
    EXPECT_EQ(read.status().code, StatusCode::corrupt);
    return read.ok() ? "" : read.status().message;
  }

  test::TemporaryFolder folder_;
  std::string path_ = score_layer_path(folder_.path());
};

TEST_F(ScoreLayerFile, IsReadAsItWasWritten) {
  score::ScoreLayers layers = score::default_score_layers();
  layers.round_two.bias = 7;
  score::ScoreLayer& layer = layers.round_three;
  layer.bias = -1.0 / 3;
  layer.components[4] = {{0.1, 0.2, 1.0 / 3, 1, 2, 3, 4, 5},
                         {1.0 / 7, -1e-17, 0, 3, 2, 1, -1, 1e9}};
  layer.provenance = "a \"test\"";
  ASSERT_TRUE(write_score_layers(path_, layers).ok());
  const auto read = library_score_layers(folder_.path());
  ASSERT_TRUE(read.ok()) << read.status().message;
  EXPECT_EQ(read->round_two.bias, 7);
  EXPECT_EQ(read->round_three.bias, layer.bias);
  EXPECT_EQ(read->round_three.provenance, layer.provenance);
  for (std::size_t i = 0; i < score::kScoreComponents.size(); ++i) {
    EXPECT_EQ(read->round_two.components[i].value, layers.round_two.components[i].value);
    EXPECT_EQ(read->round_three.components[i].place, layer.components[i].place);
    EXPECT_EQ(read->round_three.components[i].value, layer.components[i].value);
  }
}

TEST_F(ScoreLayerFile, ALibraryWithoutOneHasTheBuiltInOne) {
  const auto read = library_score_layers(folder_.path());
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->round_three.provenance, score::default_score_layers().round_three.provenance);
}

TEST_F(ScoreLayerFile, DamageIsRefusedWithAReason) {
  ASSERT_TRUE(write_score_layers(path_, score::default_score_layers()).ok());
  const std::string good = test::slurp(path_);
  test::spill(path_, good.substr(0, good.size() / 2));
  EXPECT_NE(refusal().find("truncated or not JSON"), std::string::npos);
  std::string other = good;
  other.replace(other.find("_version\": 6"), 12, "_version\": 9");
  test::spill(path_, other);
  EXPECT_NE(refusal().find("version 9"), std::string::npos);
  other = good;
  other.replace(other.find("\"range\""), 7, "\"rannge\"");
  test::spill(path_, other);
  EXPECT_NE(refusal().find("unknown component rannge"), std::string::npos);
}

}  // namespace
}  // namespace bpa
