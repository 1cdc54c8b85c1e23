// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/library_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"
#include "core/scene/interpretations.hpp"

namespace bpa {
namespace {

constexpr double kTimeOfRounds = 0.7;  // of a search; the rest is for the final stages

Candidates joined(const std::vector<Candidates>& found) {
  Candidates all;
  for (const Candidates& of_model : found) all.insert(all.end(), of_model.begin(), of_model.end());
  return all;
}

// What the placements found so far explain.
struct Explained {
  std::vector<std::uint8_t> certain,
      likely;        // flags of pixels; the certain ones are searched no more
  CheckImage image;  // where these are not searched

  explicit Explained(const CheckImage& observed)
      : certain(observed.pixels.size(), 0), likely(certain), image(observed) {}

  // Returns the number of pixels that have become likely. `found` are placements that compete.
  int add(const Candidates& found, const RoundOptions& options) {
    int gained = 0;
    for (const Candidate& candidate : found) {
      if (candidate.probability < std::min(options.min_likely, options.min_certain)) continue;
      const bool is_certain = candidate.probability >= options.min_certain;
      for (const std::uint32_t pixel : candidate.explained) {
        gained += std::exchange(likely[pixel], 1) == 0;
        if (is_certain) certain[pixel] = 1, image.pixels[pixel].searched = 0;
      }
    }
    return gained;
  }
};

SceneFeatureOptions smaller_sample(SceneFeatureOptions options, double share) {
  const auto part = [share](int number) { return static_cast<int>(std::ceil(share * number)); };
  options.round_keypoints = part(options.round_keypoints);
  options.max_references = part(options.max_references);
  return options;
}

}  // namespace

void LibrarySearch::score_expected(std::vector<Search>& searches, std::vector<Candidates>& found,
                                   std::vector<ObjectTrace>* traces) const {
  for (const ExpectedPlacement& expected : request.expected) {
    for (std::size_t i = 0; i < searches.size(); ++i) {
      const ObjectModel& model = searches[i].model;
      if (model.name != expected.model) continue;
      found[i].push_back({.model = &model,
                          .refinement = {expected.camera_from_object},
                          .found_by = Source::prior});
    }
  }
  run_stages(scoring_stages(), searches, request.num_threads, found, traces);
}

Candidates LibrarySearch::run(const std::vector<std::shared_ptr<const ObjectModel>>& models,
                              std::vector<ObjectTrace>* traces, bool& cut,
                              SearchEffort& effort) const {
  std::vector<std::uint8_t> late(models.size(), 0);
  std::vector<Search> searches;
  searches.reserve(models.size());
  for (std::size_t i = 0; i < models.size(); ++i) {
    Search& search = searches.emplace_back(scene, *models[i], options.detect, layers,
                                           request.priors, request.seed);
    search.cut = &late[i];
  }
  std::vector<Candidates> found(models.size());
  Explained explained(scene.image);
  const auto explain = [&] {
    Candidates all = joined(found);
    let_compete(all, find_overlaps(all, options.scene.max_shared));
    return explained.add(all, options.rounds);
  };
  const Deadline rounds_end = deadline.part(kTimeOfRounds);
  for (Search& search : searches) search.deadline = rounds_end;
  SceneSample sample = scene.sample;
  const bool follows = !request.expected.empty();
  if (follows) {
    score_expected(searches, found, traces);
    explain();
    sample = next_sample(scene, {}, explained.certain,
                         smaller_sample(options.features, options.rounds.expected_share));
  }
  for (int round = 0; round < options.rounds.max_rounds && !sample.empty(); ++round) {
    for (Search& search : searches) {
      search.round = round;
      search.before = &found[&search - searches.data()];
      search.sample = &sample;
      search.image = &explained.image;
    }
    ++effort.rounds;
    std::vector<Candidates> now(models.size());
    run_stages(round_stages(), searches, request.num_threads, now, traces);
    for (std::size_t i = 0; i < models.size(); ++i) {
      std::ranges::move(now[i], std::back_inserter(found[i]));
    }
    if (rounds_end.passed()) break;
    const int gained = explain();
    const bool may_end = follows || round > 0;
    if (may_end && gained < options.rounds.min_gain_px) break;
    sample = next_sample(scene, sample, explained.certain, options.features);
  }
  for (std::size_t i = 0; i < models.size(); ++i) {
    searches[i].before = nullptr;
    suppress_duplicates(searches[i], found[i]);
    searches[i].deadline = deadline;
  }
  run_stages(final_stages(), searches, request.num_threads, found, traces);
  for (const Search& search : searches) effort += search.effort;
  cut = std::ranges::count(late, 1) > 0;
  return joined(found);
}

}  // namespace bpa
