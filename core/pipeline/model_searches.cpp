// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/model_searches.hpp"

#include <algorithm>
#include <utility>

#include "core/detect/ranking.hpp"

namespace bpa {
namespace {

detect::Search search_for(const SearchInputs& inputs, const ObjectModel& model) {
  return detect::Search(inputs.scene, model, inputs.plan.detect, inputs.layers,
                        inputs.request.priors, inputs.request.seed);
}

}  // namespace

LocalSearches::LocalSearches(const SearchInputs& inputs, std::vector<detect::ObjectTrace>* traces)
    : inputs_(inputs),
      traces_(traces),
      late_(inputs.models.size(), 0),
      certain_(inputs.scene.image.pixels.size(), 0),
      image_(inputs.scene.image) {
  found_.resize(inputs.models.size());
  searches_.reserve(inputs.models.size());
  for (std::size_t i = 0; i < inputs.models.size(); ++i) {
    searches_.push_back(search_for(inputs, *inputs.models[i]));
    searches_.back().cut = &late_[i];
  }
}

void LocalSearches::run(std::span<const detect::Stage> stages, const Deadline& deadline,
                        std::vector<detect::Candidates>& found) {
  for (detect::Search& search : searches_) search.deadline = deadline;
  detect::run_stages(stages, searches_, inputs_.request.num_threads, found, traces_);
}

void LocalSearches::explain(const std::vector<std::uint32_t>& newly_certain) {
  for (const std::uint32_t pixel : newly_certain) {
    certain_[pixel] = 1;
    image_.pixels[pixel].searched = 0;
  }
}

void LocalSearches::score_expected(const Deadline& deadline) {
  for (const ExpectedPlacement& expected : inputs_.request.expected) {
    for (std::size_t i = 0; i < searches_.size(); ++i) {
      const ObjectModel& model = searches_[i].model;
      if (model.name != expected.model) continue;
      found_[i].push_back({.model = &model,
                           .refinement = {expected.frame_from_object},
                           .found_by = detect::Source::prior,
                           .is_protected = true});
    }
  }
  run(detect::scoring_stages(), deadline, found_);
}

void LocalSearches::run_round(const RoundPlan& plan) {
  explain(plan.newly_certain);
  static const SceneSample none;
  const bool is_prepared = plan.points == inputs_.scene.sample.points;
  sample_ = is_prepared ? inputs_.scene.sample
                        : scene_sample(inputs_.scene, plan.points, certain_, inputs_.plan.features);
  const detect::DetectPlan of_round = detect::round_plan(inputs_.plan.detect, plan.share);
  for (std::size_t i = 0; i < searches_.size(); ++i) {
    detect::Search& search = searches_[i];
    search.round = plan.number;
    search.before = &found_[i];
    search.sample = plan.left_out[i] ? &none : &sample_;
    search.image = &image_;
    search.plan = of_round;
  }
  std::vector<detect::Candidates> now(searches_.size());
  run(detect::round_stages(), plan.deadline, now);
  for (std::size_t i = 0; i < searches_.size(); ++i) {
    std::ranges::move(now[i], std::back_inserter(found_[i]));
  }
}

void LocalSearches::finish(const FinalPlan& plan) {
  explain(plan.newly_certain);
  const detect::DetectPlan of_final = detect::final_plan(inputs_.plan.detect, plan.share);
  for (std::size_t i = 0; i < searches_.size(); ++i) {
    searches_[i].before = nullptr;
    detect::suppress_duplicates(searches_[i], found_[i]);
    searches_[i].plan = of_final;
  }
  run(detect::final_stages(), plan.deadline, found_);
}

bool LocalSearches::late() const { return std::ranges::count(late_, 1) > 0; }

SearchEffort LocalSearches::effort() const {
  SearchEffort sum;
  for (const detect::Search& search : searches_) sum += search.effort;
  return sum;
}

std::vector<detect::Candidates> without_duplicates(const SearchInputs& inputs,
                                                   std::vector<detect::Candidates> found) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].empty()) continue;
    std::erase_if(found[i], [&](const detect::Candidate& candidate) {
      return candidate.score < inputs.plan.detect.limits[score::Limit::selected];
    });
    detect::suppress_duplicates(search_for(inputs, *inputs.models[i]), found[i]);
  }
  return found;
}

}  // namespace bpa
