// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/library_search.hpp"

#include <set>

#include "core/base/concat.hpp"
#include "core/model/model_index.hpp"
#include "core/score/score_layer.hpp"
#include "tests/support/l_scene.hpp"

namespace bpa {
namespace {

// Finds nothing, and keeps what it was told.
class FruitlessSearches : public ModelSearches {
 public:
  explicit FruitlessSearches(std::size_t models) { found_.resize(models); }

  void score_expected(const Deadline&) override {}
  void run_round(const RoundPlan& plan) override { rounds.push_back(plan); }
  void finish(const FinalPlan&) override {}
  bool late() const override { return false; }
  SearchEffort effort() const override { return {}; }

  std::vector<RoundPlan> rounds;
};

class LibrarySearchEnds : public test::LScene {
 protected:
  struct Ran {
    std::vector<RoundPlan> rounds;
    SearchOutcome outcome;
    std::size_t points = 0;  // of the scene
  };

  static Ran run(const DetectorOptions& options, const std::vector<PosePrior>& priors = {}) {
    const SceneFeatures scene = features_of(everything());
    const DetectRequest request{.priors = priors};
    const std::vector<std::shared_ptr<const ObjectModel>> models = {l_, brick_};
    const SearchPlan plan = *plan_search(options, score::default_score_layers(), {.models = 2});
    const SearchInputs inputs{scene, plan, score::default_score_layers(), request, models};
    FruitlessSearches searches(models.size());
    SearchOutcome outcome = LibrarySearch{inputs, {}}.run(searches);
    EXPECT_FALSE(outcome.cut);
    EXPECT_EQ(outcome.effort.rounds, std::ssize(searches.rounds));
    return {std::move(searches.rounds), std::move(outcome), scene.coarse.size()};
  }
  static DetectorOptions with(double max_missed, int max_rounds) {
    DetectorOptions options;
    options.rounds.max_missed = max_missed;
    options.rounds.max_rounds = max_rounds;
    options.features.max_references = 20;
    return options;
  }
};

TEST_F(LibrarySearchEnds, WhenFewObjectsAreExpectedMissed) {
  std::size_t before = 0;
  for (const double max_missed : {1.0, 0.3, 0.1}) {
    const Ran ran = run(with(max_missed, 1000));
    const double missed = ran.outcome.missed[0] + ran.outcome.missed[1];
    EXPECT_LT(missed, max_missed);
    EXPECT_GT(missed, 0);
    EXPECT_GT(ran.rounds.size(), before);
    before = ran.rounds.size();
  }
  EXPECT_TRUE(run(with(1000, 1000)).rounds.empty()) << "so many are never expected";
  EXPECT_EQ(run(with(1000, 1000), {PosePrior{}}).rounds.size(), 1u) << "of the priors";
}

TEST_F(LibrarySearchEnds, WhenAllPointsAreSearchedWithoutALimit) {
  const Ran ran = run(with(0, 1000));
  std::set<int> references;
  for (const RoundPlan& round : ran.rounds) {
    references.insert(round.points.references.begin(), round.points.references.end());
    EXPECT_EQ(round.left_out, (std::vector<std::uint8_t>{0, 0}));
  }
  EXPECT_EQ(references.size(), ran.points);
}

TEST_F(LibrarySearchEnds, AfterMaxRounds) { EXPECT_EQ(run(with(0, 5)).rounds.size(), 5u); }

TEST_F(LibrarySearchEnds, SoonerForTheModelThatShowsMore) {
  DetectorOptions options = with(0.2, 1000);
  options.features.max_references = 2;
  const Ran ran = run(options);
  const std::size_t larger = surface_area(*l_) > surface_area(*brick_) ? 0 : 1;
  const RoundPlan &first = ran.rounds.front(), &last = ran.rounds.back();
  EXPECT_EQ(first.left_out, (std::vector<std::uint8_t>{0, 0}));
  EXPECT_EQ(first.share, 1);
  EXPECT_EQ(last.left_out[larger], 1);
  EXPECT_EQ(last.left_out[1 - larger], 0);
  EXPECT_EQ(last.share, 0.5);
}

TEST_F(LibrarySearchEnds, WithTheFailureOfOtherHosts) {
  auto library = std::make_shared<ModelLibrary>();
  ASSERT_TRUE(library->add(l_).ok());
  const Detector detector(library, {});
  const Frame frame = test::render(everything(), test::kinect_camera(), 1, 8).frame;
  const auto none = [](const Models&) {
    return Result<RemoteResult>(unavailable("no host is there"));
  };
  EXPECT_EQ(detector.detect(frame, {}, nullptr, none).status().message, "no host is there");
  const auto lost = [](const Models&) {
    return Result<RemoteResult>(
        [](std::size_t) { return Result<SearchResult>(unavailable("no host is left")); });
  };
  EXPECT_EQ(detector.detect(frame, {}, nullptr, lost).status().message, "no host is left");
}

}  // namespace
}  // namespace bpa
