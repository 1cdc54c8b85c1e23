// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/library_search.hpp"

#include <algorithm>

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

// Surface that needs no further search.
struct Explained {
  std::vector<std::uint8_t> pixels;  // flags
  CheckImage image;                  // where these are not searched

  explicit Explained(const CheckImage& observed)
      : pixels(observed.pixels.size(), 0), image(observed) {}

  void add(const std::vector<std::uint32_t>& explained) {
    for (const std::uint32_t pixel : explained) {
      pixels[pixel] = 1;
      image.pixels[pixel].searched = 0;
    }
  }
};

}  // namespace

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
  SceneSample sample = scene.sample;
  const Deadline rounds_end = deadline.part(kTimeOfRounds);
  for (int round = 0; round < options.rounds.max_rounds; ++round) {
    if (round > 0) {
      if (rounds_end.passed()) break;
      Candidates all = joined(found);
      let_compete(all, find_overlaps(all, options.scene.max_shared));
      for (const Candidate& candidate : all) {
        if (candidate.probability >= options.rounds.min_certain) explained.add(candidate.explained);
      }
      sample = next_sample(scene, sample, explained.pixels, options.features);
      if (sample.empty()) break;
    }
    for (Search& search : searches) {
      search.round = round;
      search.before = &found[&search - searches.data()];
      search.sample = &sample;
      search.image = &explained.image;
      search.deadline = rounds_end;
    }
    ++effort.rounds;
    std::vector<Candidates> now(models.size());
    run_stages(round_stages(), searches, request.num_threads, now, traces);
    for (std::size_t i = 0; i < models.size(); ++i) {
      std::ranges::move(now[i], std::back_inserter(found[i]));
    }
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
