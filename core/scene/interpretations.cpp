// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include <bpa/core/base/random.hpp>
#include <bpa/core/scene/interpretations.hpp>

namespace bpa {
namespace {

// The score of a subset, kept up to date as placements come and go: a move costs as much as the
// placement has pixels.
class SubsetScore {
 public:
  SubsetScore(const std::vector<Candidate>& candidates, int observed_pixels,
              const InterpretationOptions& options)
      : candidates_(candidates), options_(options), observed_(std::max(1, observed_pixels)) {
    std::uint32_t last_pixel = 0;
    for (const Candidate& c : candidates) {
      if (!c.explained.empty()) last_pixel = std::max(last_pixel, c.explained.back());
    }
    owners_.assign(last_pixel + 1, 0);
    chosen_.assign(candidates.size(), false);
    find_conflicts();
  }

  bool chosen(std::size_t i) const { return chosen_[i]; }
  const std::vector<bool>& subset() const { return chosen_; }

  /// True when some chosen placement lies on the same pixels.
  bool blocked(std::size_t i) const {
    return std::any_of(conflicts_[i].begin(), conflicts_[i].end(),
                       [&](std::size_t j) { return bool(chosen_[j]); });
  }
  const std::vector<std::size_t>& conflicts(std::size_t i) const { return conflicts_[i]; }

  void add(std::size_t i) {
    chosen_[i] = true;
    for (std::uint32_t pixel : candidates_[i].explained) explained_ += ++owners_[pixel] == 1;
  }
  void remove(std::size_t i) {
    chosen_[i] = false;
    for (std::uint32_t pixel : candidates_[i].explained) explained_ -= --owners_[pixel] == 0;
  }

  double total() const {
    double sum = options_.explained_weight * explained_ / observed_;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (!chosen_[i]) continue;
      sum += share(i) * std::min(8.0, candidates_[i].score) - options_.object_penalty;
    }
    return sum;
  }

 private:
  // Pixels explained by k placements count 1 / k for each of them.
  double share(std::size_t i) const {
    const auto& pixels = candidates_[i].explained;
    if (pixels.empty()) return 0;
    double own = 0;
    for (std::uint32_t pixel : pixels) own += 1.0 / owners_[pixel];
    const double part = own / static_cast<double>(pixels.size());
    return candidates_[i].score > 0 ? part : 1;
  }

  void find_conflicts() {
    conflicts_.resize(candidates_.size());
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (!too_much_shared(candidates_[i], candidates_[j])) continue;
        conflicts_[i].push_back(j);
        conflicts_[j].push_back(i);
      }
    }
  }

  bool too_much_shared(const Candidate& a, const Candidate& b) const {
    std::size_t common = 0;
    auto x = a.explained.begin();
    auto y = b.explained.begin();
    while (x != a.explained.end() && y != b.explained.end()) {
      if (*x == *y) ++common;
      const bool advance_x = *x <= *y;
      const bool advance_y = *y <= *x;
      x += advance_x;
      y += advance_y;
    }
    const auto smaller = std::min(a.explained.size(), b.explained.size());
    return static_cast<double>(common) > options_.max_shared * static_cast<double>(smaller);
  }

  const std::vector<Candidate>& candidates_;
  const InterpretationOptions& options_;
  int observed_;
  int explained_ = 0;
  std::vector<bool> chosen_;
  std::vector<std::uint16_t> owners_;
  std::vector<std::vector<std::size_t>> conflicts_;
};

// The best distinct subsets met so far.
class BestSubsets {
 public:
  explicit BestSubsets(int capacity) : capacity_(static_cast<std::size_t>(capacity)) {}

  void offer(const std::vector<bool>& subset, double score) {
    if (best_.size() >= capacity_ && score <= best_.rbegin()->negated_score * -1) return;
    if (!known_.insert(subset).second) return;
    best_.insert({-score, subset});
    if (best_.size() > capacity_) {
      const auto last = std::prev(best_.end());
      known_.erase(last->subset);
      best_.erase(last);
    }
  }

  struct Entry {
    double negated_score;
    std::vector<bool> subset;
    bool operator<(const Entry& other) const {
      return negated_score != other.negated_score ? negated_score < other.negated_score
                                                  : subset < other.subset;
    }
  };
  const std::set<Entry>& entries() const { return best_; }

 private:
  std::size_t capacity_;
  std::set<Entry> best_;
  std::set<std::vector<bool>> known_;
};

// Adds what improves most, again and again.
void greedy(SubsetScore& state, const std::vector<Candidate>& candidates, BestSubsets& best) {
  double current = state.total();
  best.offer(state.subset(), current);
  for (;;) {
    double gain = 0;
    std::size_t pick = candidates.size();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (state.chosen(i) || state.blocked(i)) continue;
      state.add(i);
      const double improved = state.total() - current;
      state.remove(i);
      if (improved > gain) gain = improved, pick = i;
    }
    if (pick == candidates.size()) return;
    state.add(pick);
    current += gain;
    best.offer(state.subset(), current);
  }
}

// One random move: toggles a placement; what it conflicts with gives way. Undone if not accepted.
void anneal(SubsetScore& state, std::size_t count, const InterpretationOptions& options,
            BestSubsets& best) {
  RandomStream random(options.seed, 23);
  double current = state.total();
  for (int step = 0; step < options.annealing_steps; ++step) {
    const double temperature =
        2.0 * (1 - static_cast<double>(step) / options.annealing_steps) + 0.05;
    const auto i = static_cast<std::size_t>(random.index(static_cast<int>(count)));
    std::vector<std::size_t> removed;
    const bool was_chosen = state.chosen(i);
    if (was_chosen) {
      state.remove(i);
    } else {
      for (std::size_t j : state.conflicts(i)) {
        if (!state.chosen(j)) continue;
        state.remove(j);
        removed.push_back(j);
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

}  // namespace

std::vector<Interpretation> interpret(const std::vector<Candidate>& candidates, int observed_pixels,
                                      const InterpretationOptions& options) {
  SubsetScore state(candidates, observed_pixels, options);
  BestSubsets best(options.max_interpretations);
  greedy(state, candidates, best);
  if (!candidates.empty()) anneal(state, candidates.size(), options, best);
  std::vector<Interpretation> out;
  double total = 0;
  const double top = -best.entries().begin()->negated_score;
  for (const auto& entry : best.entries()) {
    Interpretation interpretation;
    interpretation.rank = static_cast<int>(out.size()) + 1;
    interpretation.score = -entry.negated_score;
    interpretation.probability = std::exp(interpretation.score - top);
    total += interpretation.probability;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (entry.subset[i]) interpretation.placements.push_back(to_placement(candidates[i]));
    }
    std::stable_sort(interpretation.placements.begin(), interpretation.placements.end(),
                     [](const auto& a, const auto& b) { return a.probability > b.probability; });
    out.push_back(std::move(interpretation));
  }
  for (Interpretation& interpretation : out) interpretation.probability /= total;
  return out;
}

}  // namespace bpa
