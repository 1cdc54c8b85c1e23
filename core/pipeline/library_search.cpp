// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/library_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"
#include "core/pipeline/search_plan.hpp"
#include "core/scene/interpretations.hpp"

namespace bpa {
namespace {

// Chosen by hand: of the search, for the rounds, so that the final stages have time too; and of
// what the rounds have left, for one of them, which is guessed.
constexpr double kTimeOfRounds = 0.7, kTimeOfFirstRound = 0.5, kTimeOfNextRound = 0.8;

Candidates joined(const std::vector<Candidates>& found) {
  Candidates all;
  for (const Candidates& of_model : found) all.insert(all.end(), of_model.begin(), of_model.end());
  return all;
}

// What is found so far, for those who cannot wait for the final stages.
Candidates so_far(const std::vector<Search>& searches, std::vector<Candidates> found) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    Search search = searches[i];
    search.before = nullptr;
    search.tracing = nullptr;
    suppress_duplicates(search, found[i]);
  }
  return joined(found);
}

// What the placements found so far explain.
struct Explained {
  std::vector<std::uint8_t> certain,
      likely;        // flags of pixels; the certain ones are searched no more
  CheckImage image;  // where these are not searched

  explicit Explained(const CheckImage& observed)
      : certain(observed.pixels.size(), 0), likely(certain), image(observed) {}

  // Returns the number of pixels that have become likely; with `new_places`, only those of
  // placements where nothing was likely. `found` are placements that compete.
  int add(const Candidates& found, const RoundOptions& options, bool new_places) {
    constexpr double kNewPlace = 0.5;  // of its pixels: not likely before. Chosen by hand.
    int gained = 0;
    for (const Candidate& candidate : found) {
      if (candidate.probability < std::min(options.min_likely, options.min_certain)) continue;
      const bool is_certain = candidate.probability >= options.min_certain;
      int fresh = 0;
      for (const std::uint32_t pixel : candidate.explained) {
        fresh += std::exchange(likely[pixel], 1) == 0;
        if (is_certain) certain[pixel] = 1, image.pixels[pixel].searched = 0;
      }
      const auto size = static_cast<double>(candidate.explained.size());
      if (!new_places || fresh > kNewPlace * size) gained += fresh;
    }
    return gained;
  }
};

// The share of a whole round that the next one is; 0 where no other fits.
double next_share(const SearchPace& pace, int round, const Deadline& rounds_end) {
  const double part = round == 0 ? kTimeOfFirstRound : kTimeOfNextRound;
  const double share = pace.share_of_round(part * rounds_end.milliseconds_left());
  return round == 0 ? std::max(share, kSmallestRound) : share;
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
  // Then poses were aligned well before: another round is worth its time for new places alone.
  const bool follows = !request.expected.empty();
  const auto explain = [&] {
    Candidates all = joined(found);
    let_compete(all, find_overlaps(all, options.scene.max_shared));
    return explained.add(all, options.rounds, follows);
  };
  const bool limited = !deadline.never();
  const Deadline rounds_end = deadline.part(kTimeOfRounds);
  for (Search& search : searches) search.deadline = rounds_end;
  if (follows) {
    score_expected(searches, found, traces);
    explain();
  }
  SearchPace pace(preparation_ms, static_cast<int>(models.size()));
  SceneSample sample;
  double looked_at = 0;                 // of the scene, in whole rounds
  double gained = 0, looked_since = 0;  // pixels, and whole rounds, since the gain was last judged
  // The gain judged before. The first round never ends the search, unless it follows another.
  double gained_before = follows ? 0 : std::numeric_limits<double>::infinity();
  bool ended = false;  // before time did
  for (int round = 0; !ended && looked_at < options.rounds.max_rounds; ++round) {
    const bool first_after_another = follows && round == 0;
    const double wanted = first_after_another ? options.rounds.expected_share : 1;
    const double share = limited ? std::min(wanted, next_share(pace, round, rounds_end)) : wanted;
    if (share == 0) break;
    const Stopwatch watch;
    DetectorOptions sized = share < 1 ? sized_round(options, share) : options;
    sized.features.num_threads = request.num_threads;
    if (share < wanted) raise_limits(sized.detect);
    const bool prepared = round == 0 && share == 1 && !limited && !follows;
    sample =
        prepared ? scene.sample : next_sample(scene, sample, explained.certain, sized.features);
    if (round > 0 && sample.empty()) {
      ended = true;
      break;
    }
    for (Search& search : searches) {
      search.round = round;
      search.before = &found[&search - searches.data()];
      search.sample = &sample;
      search.image = &explained.image;
      search.options = sized.detect;
    }
    ++effort.rounds;
    std::vector<Candidates> now(models.size());
    run_stages(round_stages(), searches, request.num_threads, now, traces);
    for (std::size_t i = 0; i < models.size(); ++i) {
      std::ranges::move(now[i], std::back_inserter(found[i]));
    }
    pace.took(share, watch.milliseconds());
    looked_at += share;
    looked_since += share;
    gained += explain();
    if (on_round) on_round(so_far(searches, found));
    if (looked_since < 1 && !first_after_another) continue;
    ended = gained + gained_before < options.rounds.min_gain_px;
    gained_before = std::exchange(gained, 0);
    looked_since = 0;
  }
  const double final_share = limited ? pace.share_of_final(deadline.milliseconds_left()) : 1;
  for (std::size_t i = 0; i < models.size(); ++i) {
    searches[i].before = nullptr;
    suppress_duplicates(searches[i], found[i]);
    searches[i].deadline = deadline;
    searches[i].options =
        final_share < 1 ? sized_final(options.detect, final_share) : options.detect;
  }
  run_stages(final_stages(), searches, request.num_threads, found, traces);
  for (const Search& search : searches) effort += search.effort;
  const bool whole = ended || looked_at >= options.rounds.max_rounds;
  cut = std::ranges::count(late, 1) > 0 || !whole || final_share < 1;
  return joined(found);
}

}  // namespace bpa
