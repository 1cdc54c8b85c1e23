// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scene/interpretations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa::scene {
namespace {

using Subset = std::set<int>;  // model numbers: one for each candidate

std::vector<std::uint32_t> pixels(int first, int count) {
  std::vector<std::uint32_t> out(static_cast<std::size_t>(count));
  std::iota(out.begin(), out.end(), static_cast<std::uint32_t>(first));
  return out;
}

// Candidates stand far apart; what they share is given by their pixels alone.
detect::Candidate candidate(int number, double probability, std::vector<std::uint32_t> explained) {
  static std::vector<std::unique_ptr<ObjectModel>> models;  // candidates keep pointers to them
  ObjectModel* model = models.emplace_back(std::make_unique<ObjectModel>()).get();
  model->name = "object" + std::to_string(number);
  model->number = number;
  model->diameter = 0.1;
  detect::Candidate out;
  out.model = model;
  out.refinement.frame_from_object.translation = {0.3 * number, 0, 1};
  out.probability = probability;
  out.score = std::log(probability / (1 - probability));
  out.explained = std::move(explained);
  return out;
}

Subset subset_of(const Interpretation& interpretation) {
  Subset out;
  for (const Placement& placement : interpretation.placements) {
    EXPECT_TRUE(out.insert(placement.model_number).second);
  }
  return out;
}

std::vector<Interpretation> interpret_all(const std::vector<detect::Candidate>& candidates,
                                          int observed, const InterpretationOptions& options) {
  return interpret(candidates, find_overlaps(candidates, -8), observed, options);
}

// Ranked by score alone.
InterpretationOptions by_score() {
  InterpretationOptions options;
  options.max_different = 1;
  return options;
}

std::optional<double> score_of(const std::vector<detect::Candidate>& candidates, int observed,
                               const Subset& wanted) {
  InterpretationOptions options;
  options.annealing_steps = 3000;
  for (const Interpretation& found : interpret_all(candidates, observed, options)) {
    if (subset_of(found) == wanted) return found.score;
  }
  return std::nullopt;
}

// Scores of all subsets, put together from those of one and two candidates at a time; exact where
// no pixel is explained by more than two.
class Exhaustive {
 public:
  Exhaustive(const std::vector<detect::Candidate>& candidates, int observed)
      : count_(candidates.size()) {
    single_.resize(count_);
    pair_.assign(count_ * count_, 0);
    for (std::size_t i = 0; i < count_; ++i) {
      const int a = candidates[i].model->number;
      single_[i] = score_of({candidates[i]}, observed, {a}).value_or(kForbidden);
      for (std::size_t j = 0; j < i; ++j) {
        const int b = candidates[j].model->number;
        const auto both = score_of({candidates[i], candidates[j]}, observed, {a, b});
        pair_[i * count_ + j] = both ? *both - single_[i] - single_[j] : kForbidden;
      }
    }
  }

  double score(std::uint32_t bits) const {
    double sum = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      if (!(bits >> i & 1)) continue;
      sum += single_[i];
      for (std::size_t j = 0; j < i; ++j) {
        if (bits >> j & 1) sum += pair_[i * count_ + j];
      }
    }
    return sum;
  }

  std::vector<double> best_scores(std::size_t wanted) const {
    std::vector<double> scores;
    for (std::uint32_t bits = 0; bits < (1u << count_); ++bits) scores.push_back(score(bits));
    std::sort(scores.rbegin(), scores.rend());
    scores.resize(std::min(wanted, scores.size()));
    return scores;
  }

 private:
  static constexpr double kForbidden = -1e9;
  std::size_t count_;
  std::vector<double> single_, pair_;
};

// Neighbours along a row of pixels share nothing up to 42 % of themselves.
std::vector<detect::Candidate> row_of_candidates(int count, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<detect::Candidate> candidates;
  double first = 0;
  for (int i = 0; i < count; ++i) {
    const int length = 800 + random.index(200);
    candidates.push_back(
        candidate(i, random.uniform(0.5, 0.99), pixels(static_cast<int>(first), length)));
    first += length * (1 - random.uniform(0, 0.42));
  }
  return candidates;
}

constexpr int kObserved = 9000;

class InterpretationsOf : public ::testing::TestWithParam<int> {};

TEST_P(InterpretationsOf, AreTheBestOfAllSubsets) {
  const int count = 4 + GetParam() % 9;
  const auto candidates = row_of_candidates(count, static_cast<std::uint64_t>(GetParam()));
  const Exhaustive all(candidates, kObserved);
  const auto found = interpret_all(candidates, kObserved, by_score());
  const auto best = all.best_scores(5);
  ASSERT_GE(found.size(), best.size());
  for (std::size_t k = 0; k < best.size(); ++k) EXPECT_NEAR(found[k].score, best[k], 1e-6) << k;
  for (const Interpretation& interpretation : found) {
    std::uint32_t bits = 0;
    for (const int number : subset_of(interpretation)) bits |= 1u << number;
    EXPECT_NEAR(interpretation.score, all.score(bits), 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, InterpretationsOf, ::testing::Range(0, 18));

TEST(Interpretations, AreRankedDistinctAndSumToOne) {
  const auto found = interpret_all(row_of_candidates(12, 3), kObserved, by_score());
  ASSERT_GT(found.size(), 20u);
  EXPECT_LE(found.size(), 100u);
  std::set<Subset> seen;
  double sum = 0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(found[k].rank, static_cast<int>(k) + 1);
    if (k > 0) {
      EXPECT_LE(found[k].score, found[k - 1].score);
      EXPECT_LE(found[k].probability, found[k - 1].probability);
    }
    EXPECT_GT(found[k].probability, 0);
    sum += found[k].probability;
    EXPECT_TRUE(seen.insert(subset_of(found[k])).second);
    const auto& placements = found[k].placements;
    EXPECT_TRUE(std::is_sorted(placements.begin(), placements.end(),
                               [](auto& a, auto& b) { return a.presence > b.presence; }));
  }
  EXPECT_NEAR(sum, 1, 1e-9);
}

TEST(Interpretations, WhatDiffersComesBeforeNearCopies) {
  // Three places; at each, rivals of falling probability.
  std::vector<detect::Candidate> candidates;
  const double probabilities[3][3] = {{0.6, 0.25, 0.1}, {0.9, 0.06, 0.0}, {0.3, 0.2, 0.1}};
  int number = 0;
  for (int place = 0; place < 3; ++place) {
    for (double p : probabilities[place]) {
      if (p > 0) candidates.push_back(candidate(number, p, pixels(3000 * place, 1000)));
      ++number;
    }
  }
  InterpretationOptions options;
  options.min_probability = 0.5;
  const auto found = interpret_all(candidates, kObserved, options);
  ASSERT_GT(found.size(), 3u);
  EXPECT_EQ(subset_of(found[0]), (Subset{0, 3}));
  EXPECT_EQ(subset_of(found[1]), (Subset{1, 4, 6})) << "what the first has not shown";
  EXPECT_EQ(subset_of(found[2]), (Subset{2, 3, 7})) << "with the best where all has been shown";
  EXPECT_EQ(subset_of(found[3]), (Subset{0, 3, 8}));
  double sum = 0;
  std::set<Subset> seen;
  for (const Interpretation& interpretation : found) {
    EXPECT_TRUE(seen.insert(subset_of(interpretation)).second);
    EXPECT_LE(interpretation.probability, found[0].probability);
    EXPECT_NEAR(std::log(interpretation.probability / found[0].probability),
                interpretation.score - found[0].score, 1e-9);
    sum += interpretation.probability;
  }
  EXPECT_NEAR(sum, 1, 1e-9);
}

TEST(Interpretations, OfNoCandidatesAreOneWithoutObjects) {
  for (const int observed : {0, 1000}) {
    const auto found = interpret_all({}, observed, {});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].rank, 1);
    EXPECT_EQ(found[0].probability, 1);
    EXPECT_TRUE(found[0].placements.empty());
  }
}

TEST(Interpretations, KeepNoMoreThanAsked) {
  InterpretationOptions options = by_score();
  options.max_interpretations = 7;
  const auto few = interpret_all(row_of_candidates(10, 4), kObserved, options);
  options.max_interpretations = 100;
  const auto many = interpret_all(row_of_candidates(10, 4), kObserved, options);
  ASSERT_EQ(few.size(), 7u);
  ASSERT_GT(many.size(), 7u);
  for (std::size_t k = 0; k < few.size(); ++k) {
    EXPECT_EQ(subset_of(few[k]), subset_of(many[k]));
    EXPECT_NEAR(few[k].score, many[k].score, 1e-9);
  }
}

TEST(Interpretations, OnlyOneOfTwoOnTheSamePixels) {
  const std::vector<detect::Candidate> rivals{candidate(0, 0.9, pixels(0, 1000)),
                                              candidate(1, 0.8, pixels(100, 1000))};
  const auto found = interpret_all(rivals, 3000, {});
  EXPECT_EQ(subset_of(found[0]), Subset{0});
  for (const Interpretation& interpretation : found) {
    EXPECT_LE(interpretation.placements.size(), 1u);
  }
}

TEST(Interpretations, ProbableOnesAreInAndImprobableOnesOut) {
  const std::vector<detect::Candidate> three{candidate(0, 0.95, pixels(0, 900)),
                                             candidate(1, 0.05, pixels(2000, 900)),
                                             candidate(2, 0.9, pixels(4000, 900))};
  EXPECT_EQ(subset_of(interpret_all(three, kObserved, {})[0]), (Subset{0, 2}));
}

TEST(Interpretations, WhatIsLessProbableThanAskedIsNotInTheBestHoweverMuchItExplains) {
  const std::vector<detect::Candidate> one{candidate(0, 0.25, pixels(0, 4000))};
  InterpretationOptions options;
  options.min_probability = 0.3;
  const auto found = interpret_all(one, kObserved, options);
  EXPECT_EQ(subset_of(found.at(0)), Subset{});
  EXPECT_EQ(subset_of(found.at(1)), Subset{0}) << "but in a later one";
  options.min_probability = 0.2;
  EXPECT_EQ(subset_of(interpret_all(one, kObserved, options)[0]), Subset{0});
}

TEST(Interpretations, AnObjectIsChosenByItsPresenceAtItsLikeliestPose) {
  const detect::Candidate mug = candidate(0, 0.5, pixels(0, 900));
  std::vector<detect::Candidate> poses;
  for (const double odds : {3.0, 4.0, 2.5}) {
    detect::Candidate& pose = poses.emplace_back(mug);
    pose.refinement.frame_from_object.rotation =
        Eigen::AngleAxisd(static_cast<double>(poses.size()) * M_PI / 2, Eigen::Vector3d::UnitX());
    pose.score = std::log(odds);
  }
  let_compete(poses, find_overlaps(poses, -8));
  const auto found = interpret_all(poses, kObserved, {});
  ASSERT_EQ(found[0].placements.size(), 1u);
  const Placement& placement = found[0].placements[0];
  EXPECT_NEAR(placement.presence, 9.5 / 10.5, 1e-9);
  EXPECT_NEAR(placement.probability, 4 / 10.5, 1e-9);
  EXPECT_NEAR(pose_error(placement.frame_from_object, poses[1].pose()).angle, 0, 1e-9);
  EXPECT_EQ(placement.alternatives.size(), 2u);
  EXPECT_TRUE(pose_is_open(placement));
  InterpretationOptions options;
  options.min_pose_probability = 0.4;
  EXPECT_TRUE(interpret_all(poses, kObserved, options)[0].placements.empty());
  options = {};
  options.min_probability = 0.91;
  EXPECT_TRUE(interpret_all(poses, kObserved, options)[0].placements.empty());
}

TEST(Interpretations, APenaltyLargeEnoughLeavesNothing) {
  InterpretationOptions options;
  options.object_penalty = 100;
  EXPECT_TRUE(interpret_all(row_of_candidates(8, 5), kObserved, options)[0].placements.empty());
}

TEST(Interpretations, ExplainingNothingIsWorthNothing) {
  const std::vector<detect::Candidate> two{candidate(0, 0.99, {}),
                                           candidate(1, 0.9, pixels(0, 800))};
  EXPECT_EQ(subset_of(interpret_all(two, kObserved, {})[0]), Subset{1});
}

TEST(Interpretations, SameSeedSameInterpretations) {
  const auto candidates = row_of_candidates(40, 6);
  const auto a = interpret_all(candidates, 40000, {});
  const auto b = interpret_all(candidates, 40000, {});
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].score, b[k].score);
    EXPECT_EQ(subset_of(a[k]), subset_of(b[k]));
  }
}

TEST(Interpretations, SeedsAgreeOnTheBest) {
  const auto candidates = row_of_candidates(40, 7);
  InterpretationOptions options;
  const auto first = interpret_all(candidates, 40000, options);
  for (options.seed = 1; options.seed < 5; ++options.seed) {
    EXPECT_NEAR(interpret_all(candidates, 40000, options)[0].score, first[0].score, 1e-6);
  }
}

TEST(Interpretations, WithoutAnnealingTheGreedyAnswerRemains) {
  InterpretationOptions options;
  options.annealing_steps = 0;
  const auto found = interpret_all(row_of_candidates(10, 8), kObserved, options);
  EXPECT_GT(found[0].placements.size(), 1u);
  EXPECT_GT(found.size(), 1u) << "with what it passed on its way";
}

}  // namespace
}  // namespace bpa::scene
