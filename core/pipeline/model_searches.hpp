// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/stopwatch.hpp"
#include "core/detect/search.hpp"
#include "core/detect/stages.hpp"
#include "core/pipeline/detector.hpp"
#include "core/pipeline/search_plan.hpp"

namespace bpa {

/// What one round of the search does.
struct RoundPlan {
  int number = 0;
  double share = 1;          ///< Of the candidates of a whole round, what may go on, (0, 1].
  SamplePoints points = {};  ///< That are looked up in the models.
  std::vector<std::uint8_t> left_out = {};  ///< Flags of models that are not searched for.
  /// Pixels of the reduced image that are searched no more, from this round on.
  std::vector<std::uint32_t> newly_certain = {};
  Deadline deadline = {};  ///< Of the rounds.
};

/// What the final stages do.
struct FinalPlan {
  double share = 1;                               ///< Of what they would try, (0, 1].
  std::vector<std::uint32_t> newly_certain = {};  ///< As in RoundPlan.
  Deadline deadline = {};                         ///< Of the search.
};

/// The searches for some models in one scene. LibrarySearch plans the rounds and says what is
/// certain; candidates of all models compete within a round.
class ModelSearches {
 public:
  virtual ~ModelSearches() = default;

  /// Scores the placements that an earlier frame showed (DetectRequest::expected).
  virtual void score_expected(const Deadline& deadline) = 0;
  /// Adds what a round finds.
  virtual void run_round(const RoundPlan& plan) = 0;
  /// Runs the final stages.
  virtual void finish(const FinalPlan& plan) = 0;

  /// The candidates so far, of each model.
  const std::vector<detect::Candidates>& found() const { return found_; }
  /// Whether a stage was cut by its deadline.
  virtual bool late() const = 0;
  /// The work so far, without the number of rounds.
  virtual SearchEffort effort() const = 0;

 protected:
  std::vector<detect::Candidates> found_;
};

/// What the searches for a library's models read; keeps references.
struct SearchInputs {
  const SceneFeatures& scene;
  const SearchPlan& plan;
  const score::ScoreLayers& layers;
  const DetectRequest& request;
  const std::vector<std::shared_ptr<const ObjectModel>>& models;
};

/// The stages of the detector. `traces`, if given, receives them for each model.
class LocalSearches : public ModelSearches {
 public:
  explicit LocalSearches(const SearchInputs& inputs,
                         std::vector<detect::ObjectTrace>* traces = nullptr);

  void score_expected(const Deadline& deadline) override;
  void run_round(const RoundPlan& plan) override;
  void finish(const FinalPlan& plan) override;
  bool late() const override;
  SearchEffort effort() const override;

 private:
  void explain(const std::vector<std::uint32_t>& newly_certain);
  void run(std::span<const detect::Stage> stages, const Deadline& deadline,
           std::vector<detect::Candidates>& found);

  const SearchInputs inputs_;
  std::vector<detect::ObjectTrace>* const traces_;
  std::vector<std::uint8_t> late_;     // flag of each model
  std::vector<std::uint8_t> certain_;  // flag of each pixel: is searched no more
  CheckImage image_;                   // where these are not searched
  SceneSample sample_;                 // of this round
  std::vector<detect::Search> searches_;
};

/// Distinct candidates of each model, for those who cannot wait for the final stages.
std::vector<detect::Candidates> without_duplicates(const SearchInputs& inputs,
                                                   std::vector<detect::Candidates> found);

}  // namespace bpa
