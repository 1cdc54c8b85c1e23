// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/library_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "core/pipeline/coverage.hpp"
#include "core/pipeline/search_plan.hpp"
#include "core/scene/interpretations.hpp"

namespace bpa {
namespace {

detect::Candidates joined(const std::vector<detect::Candidates>& found) {
  detect::Candidates all;
  for (const detect::Candidates& of_model : found)
    all.insert(all.end(), of_model.begin(), of_model.end());
  return all;
}

// What the placements found so far explain.
struct Explained {
  std::vector<float> probability;            // of each pixel's most probable placement
  std::vector<std::uint8_t> certain;         // flags of pixels that are searched no more
  std::vector<std::uint32_t> newly_certain;  // pixels, since they were last taken
  double objects = 0;                        // the expected number of right placements

  explicit Explained(std::size_t pixels) : probability(pixels, 0.0f), certain(pixels, 0) {}

  // Lets the candidates compete and adds them.
  void add(detect::Candidates found, const SearchPlan& plan) {
    scene::let_compete(found,
                       scene::find_overlaps(found, plan.detect.limits[score::Limit::competing]));
    std::ranges::stable_sort(found, std::greater(), &detect::Candidate::probability);
    std::vector<std::uint8_t> claimed(certain.size(), 0);
    objects = 0;
    for (const detect::Candidate& candidate : found) {
      const auto now = static_cast<float>(candidate.probability);
      const bool is_certain = candidate.probability >= plan.rounds.min_certain;
      std::size_t alone = 0;
      for (const std::uint32_t pixel : candidate.explained) {
        alone += !std::exchange(claimed[pixel], 1);
        probability[pixel] = std::max(probability[pixel], now);
        if (is_certain && !std::exchange(certain[pixel], 1)) newly_certain.push_back(pixel);
      }
      if (alone == 0) continue;
      objects += candidate.probability * static_cast<double>(alone) /
                 static_cast<double>(candidate.explained.size());
    }
  }
};

// Models of which little is expected, together `most`.
std::vector<std::uint8_t> improbable_models(const std::vector<double>& missed, double most) {
  std::vector<std::size_t> order(missed.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t m) { return missed[m]; });
  std::vector<std::uint8_t> flags(missed.size(), 0);
  for (const std::size_t m : order) {
    most -= missed[m];
    if (most < 0) break;
    flags[m] = 1;
  }
  return flags;
}

double sum_of(const std::vector<double>& numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), 0.0);
}

// The share of a whole round that the next one is; 0 where no other fits.
double next_share(const SearchPace& pace, const SearchPlan& plan, bool is_first,
                  const Deadline& rounds_end) {
  if (!plan.limited) return 1;
  const TimePlan& time = plan.time;
  const double part = is_first ? time.first_round : time.next_round;
  const double share =
      pace.share_of_round(part * rounds_end.milliseconds_left(), time.smallest_round);
  return std::min(1.0, is_first ? std::max(share, time.smallest_round) : share);
}

}  // namespace

SearchOutcome LibrarySearch::run(ModelSearches& searches) const {
  const SearchPlan& plan = inputs.plan;
  Explained explained(inputs.scene.image.pixels.size());
  Coverage coverage(inputs.scene, inputs.models, plan.yield, plan.features.coarse_spacing_m);
  const Deadline rounds_end = deadline.part(plan.time.rounds);
  if (!inputs.request.expected.empty()) {
    searches.score_expected(rounds_end);
    explained.add(joined(searches.found()), plan);
    coverage.explain(explained.probability);
  }
  // What was expected was not discovered by tries: it does not tell how many more there are.
  const double expected = explained.objects;
  SearchOutcome out;
  SearchPace pace(costs, preparation_ms, static_cast<int>(inputs.models.size()));
  SampledSoFar sampled;
  int round = 0;
  bool is_complete = false;
  for (;; ++round) {
    out.missed = coverage.missed(std::max(0.0, explained.objects - expected));
    // The first round tries what the caller's priors suggest, whatever is expected.
    const bool may_end = round > 0 || inputs.request.priors.empty();
    is_complete =
        may_end && (sum_of(out.missed) < plan.rounds.max_missed || round >= plan.rounds.max_rounds);
    if (is_complete) break;
    const double share = next_share(pace, plan, round == 0, rounds_end);
    if (share == 0) break;
    const auto left_out = improbable_models(out.missed, plan.rounds.max_missed / 2);
    const auto searched = static_cast<double>(std::ranges::count(left_out, 0));
    RoundPlan next{
        .number = round,
        .share = share * searched / static_cast<double>(left_out.size()),
        .points = next_points(inputs.scene, explained.certain, round_sample(plan, share), sampled),
        .left_out = left_out,
        .newly_certain = std::exchange(explained.newly_certain, {}),
        .deadline = rounds_end};
    is_complete = round > 0 && next.points.empty();
    if (is_complete) break;
    const Stopwatch watch;
    searches.run_round(next);
    pace.took(share, watch.milliseconds());
    explained.add(joined(searches.found()), plan);
    coverage.add_tries(next.points.references, next.left_out);
    coverage.explain(explained.probability);
    if (on_round) on_round(joined(without_duplicates(inputs, searches.found())));
  }
  const double final_share = plan.limited ? pace.share_of_final(deadline.milliseconds_left()) : 1;
  const Stopwatch watch;
  searches.finish({.share = final_share,
                   .newly_certain = std::exchange(explained.newly_certain, {}),
                   .deadline = deadline});
  // What a deadline cut took less than it would.
  out.measured = searches.late() ? Costs{preparation_ms, 0, 0}
                                 : pace.measured(final_share, watch.milliseconds());
  out.effort = searches.effort();
  out.effort.rounds += round;
  out.cut = searches.late() || !is_complete || final_share < 1;
  out.candidates = joined(searches.found());
  return out;
}

}  // namespace bpa
