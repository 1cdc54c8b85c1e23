// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/library_search.hpp"

#include <numeric>

#include "core/base/concat.hpp"
#include "core/score/score_layer.hpp"
#include "tests/support/l_scene.hpp"

namespace bpa {
namespace {

// Each round finds one placement, of surface that no other explains: its probability is the gain.
class ScriptedSearches : public ModelSearches {
 public:
  ScriptedSearches(const ObjectModel& model, std::vector<double> gains)
      : model_(model), gains_(std::move(gains)) {
    found_.resize(1);
  }

  void score_expected(const Deadline&) override {}
  bool run_round(const RoundPlan& plan) override {
    Candidate candidate{.model = &model_};
    candidate.refinement.camera_from_object.translation.x() = plan.number;
    candidate.score = log_odds_of(gains_.at(static_cast<std::size_t>(plan.number)));
    candidate.explained.resize(100);
    std::iota(candidate.explained.begin(), candidate.explained.end(), 100U * plan.number);
    found_[0].push_back(candidate);
    return true;
  }
  void finish(const FinalPlan&) override {}
  bool late() const override { return false; }
  SearchEffort effort() const override { return {}; }

 private:
  const ObjectModel& model_;
  const std::vector<double> gains_;
};

// Searches whose hosts are lost after the first round.
class LostSearches : public ScriptedSearches {
 public:
  using ScriptedSearches::ScriptedSearches;
  bool run_round(const RoundPlan& plan) override {
    return plan.number == 0 && ScriptedSearches::run_round(plan);
  }
  Status status() const override { return unavailable("no host is left"); }
};

class LibrarySearchEnds : public test::LScene {
 protected:
  // The rounds that a search takes whose rounds gain that much.
  static std::int64_t after(std::vector<double> gains, const DetectorOptions& options = {}) {
    const SceneFeatures scene = features_of(everything());
    const DetectRequest request;
    const std::vector<std::shared_ptr<const ObjectModel>> models = {l_};
    const SearchPlan plan = *plan_search(options, default_score_layers(), {});
    const SearchInputs inputs{scene, plan, default_score_layers(), request, models};
    ScriptedSearches searches(*l_, std::move(gains));
    const SearchOutcome out = LibrarySearch{inputs, {}}.run(searches);
    EXPECT_FALSE(out.cut);
    EXPECT_EQ(out.candidates.size(), static_cast<std::size_t>(out.effort.rounds));
    return out.effort.rounds;
  }
};

TEST_F(LibrarySearchEnds, AfterARoundThatGainsNearlyNothing) {
  EXPECT_EQ(after({0.9, 0.5, 0.9, 0.01, 0.9}), 4);
  EXPECT_EQ(after({0.01, 0.5, 0.01, 0.9}), 3) << "but not after the first";
}

TEST_F(LibrarySearchEnds, AfterTwoRoundsInARowThatGainLittle) {
  EXPECT_EQ(after({0.9, 0.1, 0.5, 0.1, 0.14, 0.9}), 5);
  EXPECT_EQ(after({0.1, 0.1, 0.9}), 2);
}

TEST_F(LibrarySearchEnds, AfterMaxRoundsWithoutLimits) {
  DetectorOptions options;
  options.rounds.min_gain = options.rounds.min_gain_of_two = 0;
  options.rounds.max_rounds = 5;
  EXPECT_EQ(after({0.9, 0.001, 0.001, 0.001, 0.001, 0.9}, options), 5);
}

TEST_F(LibrarySearchEnds, WithTheFailureOfSearchesElsewhere) {
  auto library = std::make_shared<ModelLibrary>();
  ASSERT_TRUE(library->add(l_).ok());
  const Detector detector(library, {});
  const Frame frame = test::render(everything(), test::kinect_camera(), 1, 8).frame;
  using Made = Result<std::unique_ptr<ModelSearches>>;
  const auto none = [](const auto&...) { return Made(unavailable("no host is there")); };
  EXPECT_EQ(detector.detect_elsewhere(frame, {}, none).status().message, "no host is there");
  const auto lost = [](const auto&...) {
    return Made(std::make_unique<LostSearches>(*l_, std::vector{0.9}));
  };
  EXPECT_EQ(detector.detect_elsewhere(frame, {}, lost).status().message, "no host is left");
}

}  // namespace
}  // namespace bpa
