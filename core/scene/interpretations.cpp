// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scene/interpretations.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/base/random.hpp"
#include "core/scene/overlaps.hpp"
#include "core/score/score_layer.hpp"

namespace bpa::scene {
namespace {

constexpr double kExplainedWeight = 2;  // of the ratio of explained to observed surface
// Of simulated annealing, in units of the score.
constexpr double kStartTemperature = 2, kEndTemperature = 0.05;
constexpr double kMinShown = 0.001;  // less probable placements are in no interpretation

// What a candidate that is believed so much adds to the score by itself: its log odds beyond those
// asked for, less the penalty (paper section VI, components 1 and 3).
double single_worth(const detect::Candidate& c, double belief,
                    const InterpretationOptions& options) {
  if (c.explained.empty()) return -options.object_penalty;
  // Of poses so near to one another that each is right when the others are, the best fit counts.
  constexpr double kFit = 0.1;
  return score::log_odds_of(belief) - score::log_odds_of(options.min_probability) -
         options.object_penalty + kFit * std::clamp(c.score, -10.0, 10.0);
}

// The score of a subset, kept up to date as placements come and go: a move costs as much as the
// placement has overlaps.
class SubsetScore {
 public:
  SubsetScore(const detect::Candidates& candidates, const std::vector<double>& beliefs,
              const Overlaps& overlaps, int observed_pixels, const InterpretationOptions& options)
      : per_pixel_(kExplainedWeight / std::max(1, observed_pixels)),
        overlaps_(overlaps),
        chosen_(candidates.size(), false) {
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      pixels_.push_back(static_cast<double>(candidates[i].explained.size()));
      single_.push_back(single_worth(candidates[i], beliefs[i], options));
    }
  }

  bool chosen(std::size_t i) const { return chosen_[i]; }
  const std::vector<bool>& subset() const { return chosen_; }
  double total() const { return total_; }
  const std::vector<Overlap>& overlaps(std::size_t i) const { return overlaps_[i]; }

  /// True when some chosen placement lies on the same pixels.
  bool blocked(std::size_t i) const {
    return std::ranges::any_of(overlaps_[i], [&](const Overlap& overlap) {
      return overlap.conflicting && chosen_[overlap.other];
    });
  }
  /// What adding i would change the score by, or has.
  double worth(std::size_t i) const {
    double sum = single_[i] + per_pixel_ * pixels_[i];
    for (const Overlap& overlap : overlaps_[i]) {
      if (chosen_[overlap.other]) sum -= lost(i, overlap) + per_pixel_ * overlap.common;
    }
    return sum;
  }
  // A shared pixel counts half for each of the two.
  double lost(std::size_t i, const Overlap& overlap) const {
    const auto part = [&](std::size_t k) {
      return overlap.common / std::max(1.0, pixels_[k]) * std::max(0.0, single_[k]);
    };
    return 0.5 * (part(i) + part(overlap.other));
  }
  void add(std::size_t i) {
    total_ += worth(i);
    chosen_[i] = true;
  }
  void clear() {
    std::fill(chosen_.begin(), chosen_.end(), false);
    total_ = 0;
  }
  void remove(std::size_t i) {
    chosen_[i] = false;
    total_ -= worth(i);
  }

 private:
  double per_pixel_;
  const Overlaps& overlaps_;
  std::vector<double> pixels_, single_;  // of each candidate: explained, and single_worth()
  std::vector<bool> chosen_;
  double total_ = 0;
};

// The best distinct subsets met so far.
class BestSubsets {
 public:
  explicit BestSubsets(int capacity) : capacity_(static_cast<std::size_t>(capacity)) {}

  void offer(const std::vector<bool>& subset, double score) {
    if (best_.size() >= capacity_ && score <= best_.rbegin()->negated_score * -1) return;
    if (!known_.insert(subset).second) return;
    best_.insert({-score, subset});
    if (best_.size() <= capacity_) return;
    const auto last = std::prev(best_.end());
    known_.erase(last->subset);
    best_.erase(last);
  }

  struct Entry {
    double negated_score;
    std::vector<bool> subset;
    auto operator<=>(const Entry&) const = default;
  };
  const std::set<Entry>& entries() const { return best_; }

 private:
  std::size_t capacity_;
  std::set<Entry> best_;
  std::set<std::vector<bool>> known_;
};

// Adds what improves most, again and again.
void greedy(SubsetScore& state, const std::vector<std::size_t>& among, BestSubsets& best) {
  best.offer(state.subset(), state.total());
  for (;;) {
    double gain = 0;
    const std::size_t* pick = nullptr;
    for (const std::size_t& i : among) {
      if (state.chosen(i) || state.blocked(i)) continue;
      const double improved = state.worth(i);
      if (improved > gain) {
        gain = improved;
        pick = &i;
      }
    }
    if (!pick) return;
    state.add(*pick);
    best.offer(state.subset(), state.total());
  }
}

// One random move: toggles a placement; what it conflicts with gives way. Undone if not accepted.
void anneal(SubsetScore& state, const std::vector<std::size_t>& among,
            const InterpretationOptions& options, BestSubsets& best) {
  RandomStream random(options.seed, Stream::annealing);
  double current = state.total();
  for (int step = 0; step < options.annealing_steps; ++step) {
    const double temperature =
        kStartTemperature * (1 - static_cast<double>(step) / options.annealing_steps) +
        kEndTemperature;
    const std::size_t i = among[random.index(static_cast<int>(among.size()))];
    std::vector<std::size_t> removed;
    const bool was_chosen = state.chosen(i);
    if (was_chosen) {
      state.remove(i);
    } else {
      for (const Overlap& overlap : state.overlaps(i)) {
        if (!overlap.conflicting || !state.chosen(overlap.other)) continue;
        state.remove(overlap.other);
        removed.push_back(overlap.other);
      }
      state.add(i);
    }
    const double proposed = state.total();
    if (proposed >= current || random.uniform() < std::exp((proposed - current) / temperature)) {
      current = proposed;
      best.offer(state.subset(), current);
      continue;
    }
    if (was_chosen) {
      state.add(i);
    } else {
      state.remove(i);
      for (std::size_t j : removed) state.add(j);
    }
  }
}

using Entry = BestSubsets::Entry;

// See interpret(): first what differs, then what is left of the best.
std::vector<Entry> rank(SubsetScore& state, const std::vector<std::size_t>& among,
                        const std::vector<double>& beliefs, const score::Competition& competition,
                        BestSubsets& best, const InterpretationOptions& options) {
  // What no interpretation has shown yet, by falling belief. Nearly the same pose of the same
  // model counts as shown as well.
  std::vector<std::size_t> unshown = among;
  std::ranges::stable_sort(unshown, std::greater(), [&](std::size_t i) { return beliefs[i]; });
  const auto show = [&](const std::vector<bool>& subset) {
    const auto shown = [&](const score::Competition::Rival& rival) {
      return rival.same_pose > 0.5 && subset[rival.other];
    };
    std::erase_if(unshown, [&](std::size_t i) {
      return subset[i] || std::ranges::any_of(competition.rivals[i], shown);
    });
  };
  std::vector<Entry> ranked{*best.entries().begin()};
  show(ranked.front().subset);
  while (std::ssize(ranked) < options.max_different && !unshown.empty()) {
    state.clear();
    for (std::size_t i : unshown) {
      if (!state.blocked(i)) state.add(i);
    }
    greedy(state, among, best);
    ranked.push_back({-state.total(), state.subset()});
    show(state.subset());
  }
  std::set<std::vector<bool>> known;
  for (const Entry& entry : ranked) known.insert(entry.subset);
  for (const Entry& entry : best.entries()) {
    if (std::ssize(ranked) >= options.max_interpretations) break;
    if (known.insert(entry.subset).second) ranked.push_back(entry);
  }
  return ranked;
}

std::vector<double> scores_of(const detect::Candidates& candidates) {
  std::vector<double> scores;
  for (const detect::Candidate& candidate : candidates) scores.push_back(candidate.score);
  return scores;
}

// The placements of the candidates `among`, by candidate; of the others empty.
std::vector<Placement> placements_of(const detect::Candidates& candidates,
                                     const std::vector<std::size_t>& among,
                                     const score::Competition& competition) {
  const std::vector<double> presence =
      score::competing_probabilities(scores_of(candidates), of_objects(candidates, competition));
  std::vector<Placement> out(candidates.size());
  for (const std::size_t i : among) {
    out[i] = detect::to_placement(candidates[i]);
    out[i].alternatives = alternatives_of(candidates, competition, i);
    out[i].presence = std::max(presence[i], out[i].probability);
  }
  return out;
}

// Where a pose is open, the likeliest one stands for the object.
double belief_in(const Placement& placement) {
  const auto& others = placement.alternatives;
  const bool stands_for_object = !others.empty() && own_weight(placement) >= others.front().weight;
  return stands_for_object ? placement.presence : placement.probability;
}

}  // namespace

void let_compete(detect::Candidates& candidates, const Overlaps& overlaps) {
  const std::vector<double> probabilities =
      score::competing_probabilities(scores_of(candidates), competition_of(candidates, overlaps));
  for (std::size_t i = 0; i < candidates.size(); ++i) candidates[i].probability = probabilities[i];
}

std::vector<Interpretation> interpret(const detect::Candidates& candidates,
                                      const Overlaps& overlaps, int observed_pixels,
                                      const InterpretationOptions& options) {
  std::vector<std::size_t> among, probable;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i].probability >= kMinShown) among.push_back(i);
  }
  const score::Competition competition = competition_of(candidates, overlaps);
  const std::vector<Placement> placements = placements_of(candidates, among, competition);
  std::vector<double> beliefs(candidates.size(), 0);
  for (const std::size_t i : among) {
    beliefs[i] = belief_in(placements[i]);
    const bool is_probable = beliefs[i] >= options.min_probability &&
                             placements[i].probability >= options.min_pose_probability;
    if (is_probable) probable.push_back(i);
  }
  SubsetScore state(candidates, beliefs, overlaps, observed_pixels, options);
  BestSubsets best(options.max_interpretations);
  greedy(state, probable, best);
  if (!probable.empty()) anneal(state, probable, options, best);
  std::vector<Interpretation> out;
  double total = 0, top = 0;
  for (const Entry& entry : rank(state, among, beliefs, competition, best, options)) {
    const double score = -entry.negated_score;
    if (out.empty()) top = score;
    Interpretation& interpretation = out.emplace_back(
        Interpretation{static_cast<int>(out.size()) + 1, score, std::exp(score - top), {}});
    total += interpretation.probability;
    for (const std::size_t i : among) {
      if (entry.subset[i]) interpretation.placements.push_back(placements[i]);
    }
    std::ranges::stable_sort(interpretation.placements, std::greater(), &Placement::presence);
  }
  for (Interpretation& interpretation : out) interpretation.probability /= total;
  return out;
}

void keep_best(std::vector<Interpretation>& interpretations, std::size_t count) {
  if (interpretations.size() <= count) return;
  interpretations.resize(count);
  double sum = 0;
  for (const Interpretation& interpretation : interpretations) sum += interpretation.probability;
  for (Interpretation& interpretation : interpretations) interpretation.probability /= sum;
}

}  // namespace bpa::scene
