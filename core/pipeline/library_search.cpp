// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/library_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/pipeline/search_plan.hpp"
#include "core/scene/interpretations.hpp"

namespace bpa {
namespace {

Candidates joined(const std::vector<Candidates>& found) {
  Candidates all;
  for (const Candidates& of_model : found) all.insert(all.end(), of_model.begin(), of_model.end());
  return all;
}

// What the placements found so far explain.
struct Explained {
  std::vector<float> probability;            // of each pixel's most probable placement
  std::vector<std::uint8_t> certain;         // flags of pixels that are searched no more
  std::vector<std::uint32_t> newly_certain;  // pixels, since they were last taken

  explicit Explained(std::size_t pixels) : probability(pixels, 0.0f), certain(pixels, 0) {}

  // Lets the candidates compete and adds them. Returns the largest gain of one: how much more
  // probable it makes its surface than what was there, in the mean of its pixels.
  double add(Candidates found, const SearchPlan& plan) {
    const RoundOptions& options = plan.rounds;
    let_compete(found, find_overlaps(found, plan.detect.limits[Limit::competing]));
    std::vector<const Candidate*> probable;
    for (const Candidate& candidate : found) {
      if (candidate.probability < std::min(options.min_gain, options.min_certain)) continue;
      if (!candidate.explained.empty()) probable.push_back(&candidate);
    }
    // The right one first: worse poses of its place are no gain.
    std::ranges::stable_sort(probable, std::greater(), &Candidate::probability);
    double most = 0;
    for (const Candidate* candidate : probable) {
      const auto now = static_cast<float>(candidate->probability);
      const bool is_certain = candidate->probability >= options.min_certain;
      double gain = 0;
      for (const std::uint32_t pixel : candidate->explained) {
        gain += double{std::max(0.0f, now - probability[pixel])};
        probability[pixel] = std::max(probability[pixel], now);
        if (is_certain && !std::exchange(certain[pixel], 1)) newly_certain.push_back(pixel);
      }
      most = std::max(most, gain / static_cast<double>(candidate->explained.size()));
    }
    return most;
  }
};

// Judges each whole round by its gain; small ones are judged together.
class RoundEnd {
 public:
  explicit RoundEnd(const SearchPlan& plan) : rule_(plan.end), most_(plan.rounds.max_rounds) {}

  bool reached() const { return reached_ || searched_ >= most_; }
  void nothing_left() { reached_ = true; }
  void add(double share, double gain) {
    const bool may_end = rule_.may_end_at_first, is_first = searched_ == 0;
    searched_ += share;
    since_judged_ += share;
    gain_ = std::max(gain_, gain);
    if (since_judged_ < 1 && !(may_end && is_first)) return;
    const double of_two = std::max(gain_, gain_before_);
    reached_ =
        (may_end || searched_ >= 2) && (gain_ < rule_.min_gain || of_two < rule_.min_gain_of_two);
    gain_before_ = std::exchange(gain_, 0);
    since_judged_ = 0;
  }

 private:
  const EndRule rule_;
  const double most_;
  double searched_ = 0, since_judged_ = 0;  // in whole rounds
  double gain_ = 0, gain_before_ = 1;
  bool reached_ = false;
};

// The share of a whole round that the next one is; 0 where no other fits.
double next_share(const SearchPace& pace, const SearchPlan& plan, bool is_first,
                  const Deadline& rounds_end) {
  const double wanted = is_first ? plan.end.first_share : 1;
  if (!plan.limited) return wanted;
  const TimePlan& time = plan.time;
  const double part = is_first ? time.first_round : time.next_round;
  const double share =
      pace.share_of_round(part * rounds_end.milliseconds_left(), time.smallest_round);
  return std::min(wanted, is_first ? std::max(share, time.smallest_round) : share);
}

}  // namespace

SearchOutcome LibrarySearch::run(ModelSearches& searches) const {
  const SearchPlan& plan = inputs.plan;
  Explained explained(inputs.scene.image.pixels.size());
  const bool follows = !inputs.request.expected.empty();
  const Deadline rounds_end = deadline.part(plan.time.rounds);
  if (follows) {
    searches.score_expected(rounds_end);
    explained.add(joined(searches.found()), plan);
  }
  SearchOutcome out;
  SearchPace pace(costs, preparation_ms, static_cast<int>(inputs.models.size()));
  RoundEnd end(plan);
  int round = 0;
  for (; !end.reached(); ++round) {
    const bool is_first = round == 0;
    const double share = next_share(pace, plan, is_first, rounds_end);
    if (share == 0) break;
    const Stopwatch watch;
    if (!searches.run_round({.number = round,
                             .share = share,
                             .hurried = share < (is_first ? plan.end.first_share : 1),
                             .first_sample = is_first && share == 1 && !plan.limited && !follows,
                             .newly_certain = std::exchange(explained.newly_certain, {}),
                             .deadline = rounds_end})) {
      end.nothing_left();
      break;
    }
    pace.took(share, watch.milliseconds());
    end.add(share, explained.add(joined(searches.found()), plan));
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
  out.cut = searches.late() || !end.reached() || final_share < 1;
  out.candidates = joined(searches.found());
  return out;
}

}  // namespace bpa
