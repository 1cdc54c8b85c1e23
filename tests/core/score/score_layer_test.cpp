// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/score_layer.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/random.hpp"

namespace bpa::score {
namespace {

double sigmoid(double x) { return 1 / (1 + std::exp(-x)); }

TEST(Competition, WithoutRivalsIsALogistic) {
  const std::vector<double> scores{-3, 0, 2.5, 40, -800};
  const auto p = competing_probabilities(scores, {std::vector<std::vector<Competition::Rival>>(5)});
  for (std::size_t i = 0; i < scores.size(); ++i) EXPECT_NEAR(p[i], sigmoid(scores[i]), 1e-12);
}

TEST(Competition, RivalsShareWhatNothingLeaves) {
  Competition competition;
  competition.rivals = {{{1, 0}, {2, 1}}, {{0, 0}, {2, 0}}, {{0, 0.25}, {1, 0}}};
  const std::vector<double> scores{1, 2, 0.5};
  const double all = 1 + std::exp(1) + std::exp(2) + std::exp(0.5);
  const auto p = competing_probabilities(scores, competition);
  EXPECT_NEAR(p[0], (std::exp(1) + std::exp(0.5)) / all, 1e-12) << "two of one pose";
  EXPECT_NEAR(p[1], std::exp(2) / all, 1e-12);
  EXPECT_NEAR(p[2], (std::exp(0.5) + 0.25 * std::exp(1)) / all, 1e-12) << "half beside it";
  EXPECT_LT(p[0] + p[1], 1);
}

TEST(Competition, LargeScoresDoNotOverflow) {
  Competition competition;
  competition.rivals = {{{1, 0}}, {{0, 0}}};
  const auto p = competing_probabilities(std::vector<double>{1000, 1001}, competition);
  EXPECT_NEAR(p[0], sigmoid(-1), 1e-9);
  EXPECT_NEAR(p[1], sigmoid(1), 1e-9);
}

// Frames whose labels are drawn from a known law: log odds 4 range + 6 agreeing - 4, of which one
// of a pair of rivals at most is right.
std::vector<ScoreFrame> drawn_frames(int count, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<ScoreFrame> frames;
  for (int k = 0; k < count; ++k) {
    ScoreFrame frame;
    frame.samples.resize(20);
    frame.competition.rivals.resize(20);
    for (std::uint32_t i = 0; i < 20; i += 2) {
      double odds[2];
      for (std::uint32_t j = 0; j < 2; ++j) {
        ScoreValues& x = frame.samples[i + j].values;
        x.fill(0.5);
        x[0] = random.uniform(-1, 0);
        x[2] = random.uniform(0, 1);
        odds[j] = std::exp(4 * x[0] + 6 * x[2] - 4);
        frame.competition.rivals[i + j] = {{i + 1 - j, 0}};
      }
      const double draw = random.uniform() * (1 + odds[0] + odds[1]);
      frame.samples[i].right = draw < odds[0];
      frame.samples[i + 1].right = draw >= odds[0] && draw < odds[0] + odds[1];
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

TEST(ScoreLayer, TrainingFindsTheLawThatDrewTheLabels) {
  const auto layer = train_score_layer(drawn_frames(1000, 1));
  ASSERT_TRUE(layer.ok()) << layer.status().message;
  RandomStream random(2);
  for (int k = 0; k < 50; ++k) {
    ScoreValues x;
    x.fill(0.5);
    x[0] = random.uniform(-0.95, -0.05);
    x[2] = random.uniform(0.05, 0.95);
    EXPECT_NEAR(layer->log_odds(x), 4 * x[0] + 6 * x[2] - 4, 0.5);
  }
  const Reliability held_out = reliability(*layer, drawn_frames(600, 3));
  EXPECT_LT(held_out.expected_calibration_error, 0.02);
  EXPECT_EQ(held_out.samples, 12000);
}

// A camera that differs from those learned from: the same law, three log odds bolder.
TEST(ScoreLayer, AFewFramesAdaptALayer) {
  const auto learned = train_score_layer(drawn_frames(1000, 1));
  ASSERT_TRUE(learned.ok()) << learned.status().message;
  ScoreLayer bold = *learned;
  bold.bias += 3;
  const auto few = drawn_frames(20, 5), unseen = drawn_frames(600, 6);
  const auto adapted = adapt_score_layer(bold, few);
  ASSERT_TRUE(adapted.ok()) << adapted.status().message;
  const auto anew = train_score_layer(few);
  ASSERT_TRUE(anew.ok()) << anew.status().message;
  const double best = reliability(*learned, unseen).log_loss;
  EXPECT_GT(reliability(bold, unseen).log_loss, best + 0.2);
  EXPECT_LT(reliability(*adapted, unseen).log_loss, best + 0.03);
  EXPECT_LT(reliability(*adapted, unseen).log_loss, reliability(*anew, unseen).log_loss);
}

// drawn_frames() where an outline says what component 2 does not: the law is 4 range + 6 silhouette
// - 4.
TEST(ScoreLayer, AnExtendedLayerKnowsMoreAndStaysTheSameWhereItDoesNot) {
  constexpr std::size_t kOutline = component("silhouette");
  auto frames = drawn_frames(1000, 1);
  for (ScoreFrame& frame : frames) {
    for (auto& sample : frame.samples) {
      sample.values[kOutline] = std::exchange(sample.values[2], kNotKnown);
      sample.values[component("silhouette_contrast")] = kNotKnown;
    }
  }
  auto without = frames;
  for (ScoreFrame& frame : without) {
    for (auto& sample : frame.samples) sample.values[kOutline] = kNotKnown;
  }
  const auto start = train_score_layer(without);
  ASSERT_TRUE(start.ok()) << start.status().message;
  const auto is_outline = [](const ComponentType& c) { return c.needs == Needs::outline; };
  const auto extended = extend_score_layer(*start, is_outline, frames);
  ASSERT_TRUE(extended.ok()) << extended.status().message;
  for (const ScoreFrame& frame : without) {
    for (const auto& sample : frame.samples) {
      ASSERT_EQ(extended->log_odds(sample.values), start->log_odds(sample.values));
    }
  }
  ScoreValues low = frames[0].samples[0].values, high = low;
  low[kOutline] = 0.2;
  high[kOutline] = 0.8;
  EXPECT_NEAR(extended->log_odds(high) - extended->log_odds(low), 6 * 0.6, 0.5);
  EXPECT_LT(reliability(*extended, frames).log_loss, 0.9 * reliability(*start, without).log_loss);
  EXPECT_FALSE(extend_score_layer(*start, is_outline, {}).ok());
}

// The law of drawn_frames(), halved and one log odds bolder.
TEST(ScoreLayer, CalibrationFindsScaleAndShift) {
  ScoreLayer layer;
  for (ScoreLayer::Component& component : layer.components) {
    for (std::size_t k = 0; k < ScoreLayer::kKnots; ++k) {
      component.place[k] = -1 + 2.0 * static_cast<double>(k) / (ScoreLayer::kKnots - 1);
    }
  }
  for (std::size_t k = 0; k < ScoreLayer::kKnots; ++k) {
    layer.components[0].value[k] = 0.5 * 4 * layer.components[0].place[k];
    layer.components[2].value[k] = 0.5 * 6 * layer.components[2].place[k];
  }
  layer.bias = 0.5 * -4 + 1;
  const auto calibrated = calibrate_score_layer(layer, drawn_frames(1000, 1));
  ASSERT_TRUE(calibrated.ok()) << calibrated.status().message;
  RandomStream random(2);
  for (int k = 0; k < 50; ++k) {
    ScoreValues x;
    x.fill(0.5);
    x[0] = random.uniform(-1, 0);
    x[2] = random.uniform(0, 1);
    EXPECT_NEAR(calibrated->log_odds(x), 4 * x[0] + 6 * x[2] - 4, 0.2);
  }
  const auto unseen = drawn_frames(600, 3);
  EXPECT_GT(reliability(layer, unseen).expected_calibration_error, 0.05);
  EXPECT_LT(reliability(*calibrated, unseen).expected_calibration_error, 0.01);
  EXPECT_FALSE(calibrate_score_layer(layer, {}).ok());
}

TEST(ScoreLayer, FramesThatAgreeDoNotChangeALayer) {
  const auto learned = train_score_layer(drawn_frames(1000, 1));
  ASSERT_TRUE(learned.ok()) << learned.status().message;
  const auto adapted = adapt_score_layer(*learned, drawn_frames(1000, 1));
  ASSERT_TRUE(adapted.ok()) << adapted.status().message;
  for (double range = -0.95; range < 0; range += 0.1) {
    ScoreValues x;
    x.fill(0.5);
    x[0] = range;
    EXPECT_NEAR(adapted->log_odds(x), learned->log_odds(x), 0.2);
  }
}

TEST(ScoreLayer, ACurveThatHasToRiseDoes) {
  RandomStream random(11);
  ScoreFrame frame;
  frame.samples.resize(4000);
  frame.competition.rivals.resize(4000);
  constexpr std::size_t kRising = component("range"), kAny = component("gap");
  for (auto& sample : frame.samples) {
    sample.values.fill(0);
    const double x = random.uniform();
    sample.right = random.uniform() < (x < 0.5 ? 0.8 : 0.2);
    sample.values[kRising] = sample.values[kAny] = x;
  }
  const auto layer = train_score_layer(std::vector<ScoreFrame>{frame});
  ASSERT_TRUE(layer.ok()) << layer.status().message;
  const auto& rising = layer->components[kRising].value;
  EXPECT_EQ(std::ranges::adjacent_find(rising, std::greater()), rising.end());
  const auto& any = layer->components[kAny].value;
  EXPECT_LT(any.back() - any.front(), -2) << "log odds of 0.2 less those of 0.8";
}

TEST(ScoreLayer, ReliabilityOfKnownProbabilities) {
  ScoreLayer layer;  // says 1/2 of everything, 1/3 of each of two rivals
  ScoreFrame frame;
  frame.samples.resize(4);
  frame.samples[0].right = frame.samples[2].right = true;
  frame.competition.rivals = {{}, {}, {{3, 0}}, {{2, 0}}};
  const Reliability r = reliability(layer, std::vector<ScoreFrame>{frame});
  EXPECT_EQ(r.bins[5].count, 2);
  EXPECT_NEAR(r.bins[5].right, 0.5, 1e-12);
  EXPECT_EQ(r.bins[3].count, 2);
  EXPECT_NEAR(r.bins[3].predicted, 1.0 / 3, 1e-12);
  // |1/2 - 1/2| of two samples and |1/3 - 1/2| of two.
  EXPECT_NEAR(r.expected_calibration_error, 0.5 / 6, 1e-12);
  EXPECT_NEAR(r.brier_score, (0.25 + 0.25 + 4.0 / 9 + 1.0 / 9) / 4, 1e-12);
  EXPECT_NEAR(r.log_loss, (2 * std::log(2) + std::log(3) + std::log(1.5)) / 4, 1e-12);
}

TEST(ScoreLayer, ValuesOutsideTrainingCountAsTheNearestOnes) {
  ScoreLayer layer;
  layer.components[0] = {{1, 2, 3, 4, 5, 6, 7, 8}, {-3, 0, 1, 0, 0, 0, 0, 5}};
  layer.bias = 0.5;
  const auto at = [&layer](double value) {
    ScoreValues x{};
    x[0] = value;
    return layer.log_odds(x);
  };
  EXPECT_EQ(at(8), 5.5);
  EXPECT_EQ(at(70), 5.5);
  EXPECT_EQ(at(1), -2.5);
  EXPECT_EQ(at(-1), -2.5);
  EXPECT_EQ(at(std::nan("")), 0.5) << "what is not known says nothing";
}

TEST(ScoreLayer, BetweenKnotsIsInterpolated) {
  ScoreLayer layer;
  layer.components[0] = {{1, 2, 3, 4, 5, 6, 7, 8}, {-3, 0, 1, 0, 0, 0, 0, 5}};
  EXPECT_NEAR(layer.components[0].at(1.25), -2.25, 1e-12);
  EXPECT_NEAR(layer.components[0].at(3), 1, 1e-12);
  EXPECT_NEAR(layer.components[0].at(7.5), 2.5, 1e-12);
}

// Where a value is common to many samples, and what it says is not in line with the others.
TEST(ScoreLayer, TrainingFindsAStep) {
  RandomStream random(7);
  ScoreFrame frame;
  frame.samples.resize(8000);
  frame.competition.rivals.resize(8000);
  for (auto& sample : frame.samples) {
    sample.values.fill(0);
    const bool known = random.uniform() < 0.5;
    sample.values[0] = known ? -random.uniform(0.5, 1) : 0;
    sample.right = random.uniform() < (known ? 0.2 : 0.8);
  }
  const auto layer = train_score_layer(std::vector<ScoreFrame>{frame});
  ASSERT_TRUE(layer.ok()) << layer.status().message;
  ScoreValues x{};
  EXPECT_NEAR(sigmoid(layer->log_odds(x)), 0.8, 0.03);
  x[0] = -0.7;
  EXPECT_NEAR(sigmoid(layer->log_odds(x)), 0.2, 0.03);
}

TEST(ScoreLayer, NeedsBothKindsOfSamples) {
  auto frames = drawn_frames(3, 4);
  for (ScoreFrame& frame : frames) {
    for (auto& sample : frame.samples) sample.right = false;
  }
  const auto layer = train_score_layer(frames);
  ASSERT_FALSE(layer.ok());
  EXPECT_EQ(layer.status().code, StatusCode::invalid_argument);
  EXPECT_NE(layer.status().message.find("0 right placements of 60"), std::string::npos);
}

// Reads config/score_layers.json by itself, so that the library's reader and build are judged.
TEST(ScoreLayer, TheBuiltInOnesAreTheCommittedFile) {
  const nlohmann::json file =
      nlohmann::json::parse(std::ifstream(BPA_SOURCE_DIR "/config/score_layers.json"));
  const ScoreLayers& built_in = default_score_layers();
  const std::pair<const char*, const ScoreLayer*> layers[] = {
      {"round_two", &built_in.round_two},
      {"round_three", &built_in.round_three},
      {"without_color", &built_in.without_color}};
  for (const auto& [name, layer] : layers) {
    SCOPED_TRACE(name);
    const nlohmann::json& json = file.at(name);
    EXPECT_EQ(json.at("bias"), layer->bias);
    EXPECT_EQ(json.at("provenance"), layer->provenance);
    std::size_t learned = 0;
    for (std::size_t i = 0; i < kScoreComponents.size(); ++i) {
      if (!kScoreComponents[i].learned) continue;
      const std::string component(kScoreComponents[i].name);
      SCOPED_TRACE(component);
      ASSERT_TRUE(json.at("components").contains(component));
      EXPECT_EQ(json.at("components").at(component).at("place"), layer->components[i].place);
      EXPECT_EQ(json.at("components").at(component).at("log_odds"), layer->components[i].value);
      ++learned;
    }
    EXPECT_EQ(json.at("components").size(), learned);
  }
}

TEST(ScoreLayer, TheBuiltInOnesHaveRisingPlacesAndKnowWhatTheirRoundKnows) {
  const ScoreLayers& layers = default_score_layers();
  for (std::size_t i = 0; i < kScoreComponents.size(); ++i) {
    const ComponentType& type = kScoreComponents[i];
    if (!type.learned) continue;
    SCOPED_TRACE(std::string(type.name));
    const auto says_something = [i, &type](const ScoreLayer& layer) {
      const auto& place = layer.components[i].place;
      EXPECT_EQ(std::adjacent_find(place.begin(), place.end(), std::greater_equal<>()),
                place.end());
      const auto& value = layer.components[i].value;
      const bool falls = std::ranges::adjacent_find(value, std::greater()) != value.end();
      const bool rises = std::ranges::adjacent_find(value, std::less()) != value.end();
      EXPECT_FALSE(falls && type.rises);
      return rises || falls;
    };
    const bool two = says_something(layers.round_two);
    const bool three = says_something(layers.round_three);
    const bool without_color = says_something(layers.without_color);
    EXPECT_TRUE(type.round == Round::two || !two);
    if (type.rises) continue;  // may say nothing: what they know, others say too
    EXPECT_EQ(two, type.round == Round::two);
    EXPECT_TRUE(three);
    EXPECT_EQ(without_color, type.needs != Needs::colors);
  }
}

}  // namespace
}  // namespace bpa::score
