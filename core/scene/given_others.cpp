// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scene/given_others.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

#include "core/base/median.hpp"
#include "core/base/parallel.hpp"
#include "core/score/surface_agreement.hpp"

namespace bpa::scene {
namespace {

constexpr int kNobody = -1;
// Chosen by hand.
constexpr int kJudgedPoints = 256;  // of the model that are looked at
constexpr double kPresent = 0.5;    // probability of what a first interpretation holds
constexpr double kSure = 0.85;      // of what counts as a copy; from 0.8 to 0.9 little changes

// Calls visit(pixel) for the pixels and their neighbours in an image: explained pixels are those of
// single model points, which may lie further apart than pixels.
void for_each_beside(const std::vector<std::uint32_t>& pixels, int width, int height,
                     const auto& visit) {
  for (const std::uint32_t pixel : pixels) {
    const int u = static_cast<int>(pixel) % width, v = static_cast<int>(pixel) / width;
    for (int y = std::max(0, v - 1); y <= std::min(height - 1, v + 1); ++y) {
      for (int x = std::max(0, u - 1); x <= std::min(width - 1, u + 1); ++x) {
        visit(static_cast<std::size_t>(y * width + x));
      }
    }
  }
}

// Which placement explains a pixel.
std::vector<int> owners_of(const SceneFeatures& scene, const Present& present,
                           const detect::Candidates& candidates) {
  std::vector<int> owners(scene.map.size(), kNobody);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (present[i] == 0) continue;
    for (const std::uint32_t pixel : candidates[i].explained) owners[pixel] = static_cast<int>(i);
  }
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (present[i] == 0) continue;
    for_each_beside(candidates[i].explained, scene.map.width(), scene.map.height(),
                    [&](std::size_t pixel) {
                      if (owners[pixel] == kNobody) owners[pixel] = static_cast<int>(i);
                    });
  }
  return owners;
}

// What one placement looks like given the others.
class Judge {
 public:
  Judge(const SceneFeatures& scene, const detect::Candidate& candidate,
        const std::vector<Overlap>& overlaps, const Present& present, std::size_t self,
        const std::vector<int>& owners)
      : scene_(scene), candidate_(candidate), owners_(owners), not_others_{static_cast<int>(self)} {
    for (const Overlap& overlap : overlaps) {
      if (overlap.conflicting && present[overlap.other] > 0)
        not_others_.push_back(static_cast<int>(overlap.other));
    }
  }

  // The share of the facing model points that are hidden by what no other explains.
  double hidden_by_unknown() const {
    const score::HiddenPoints hidden =
        score::hidden_points(scene_.image, *candidate_.model, candidate_.pose(), kJudgedPoints);
    const auto unknown = std::ranges::count_if(
        hidden.pixels, [&](std::uint32_t pixel) { return !of_another(pixel); });
    return static_cast<double>(unknown) / std::max(1, hidden.facing);
  }

  // The share of the super-pixels it explains that neither it nor another does; those that it
  // explains most of count most.
  double left_over() const {
    const segment::Segmentation& segmentation = scene_.segmentation;
    std::vector<int> explained(segmentation.segments.size(), 0);
    int all = 0;
    for (const std::uint32_t pixel : candidate_.explained) {
      const std::int32_t label = segmentation.labels[pixel];
      if (label < 0) continue;
      ++explained[static_cast<std::size_t>(label)];
      ++all;
    }
    if (all == 0) return score::kNotKnown;
    std::vector<bool> own(scene_.map.size(), false);
    for_each_beside(candidate_.explained, scene_.map.width(), scene_.map.height(),
                    [&](std::size_t pixel) { own[pixel] = true; });
    double sum = 0;
    for (std::size_t s = 0; s < explained.size(); ++s) {
      if (explained[s] == 0) continue;
      const auto& pixels = segmentation.segments[s].pixels;
      const auto left = std::ranges::count_if(
          pixels, [&](std::uint32_t pixel) { return !own[pixel] && !of_another(pixel); });
      sum += explained[s] * static_cast<double>(left) / static_cast<double>(pixels.size());
    }
    return sum / all;
  }

  // Counts confident detections of this model and of the commonest other model. A bin of equal
  // parts makes further copies likely. Unknown where no model has two such detections.
  double copies(const detect::Candidates& candidates, const Present& present) const {
    std::map<const ObjectModel*, int> counts;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (present[i] >= kSure && is_other(static_cast<int>(i))) ++counts[candidates[i].model];
    }
    const int own = std::exchange(counts[candidate_.model], 0);
    int most = 0;
    for (const auto& [model, count] : counts) most = std::max(most, count);
    if (std::max(own, most) < 2) return score::kNotKnown;
    return std::log((own + 1.0) / (most + 1.0));
  }

  // How much lighter it is seen than the others are: exposure is the same for all.
  double relative_exposure(const detect::Candidates& candidates, const Present& present) const {
    std::vector<double> others;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const double exposure = candidates[i].values[score::component("exposure")];
      if (present[i] > 0 && is_other(static_cast<int>(i)) && !std::isnan(exposure)) {
        others.push_back(exposure);
      }
    }
    if (others.empty()) return score::kNotKnown;
    return candidate_.values[score::component("exposure")] - median(others);
  }

 private:
  bool of_another(std::uint32_t pixel) const {
    const int owner = owners_[pixel];
    return owner != kNobody && is_other(owner);
  }
  bool is_other(int candidate) const {
    return std::ranges::find(not_others_, candidate) == not_others_.end();
  }

  const SceneFeatures& scene_;
  const detect::Candidate& candidate_;
  const std::vector<int>& owners_;
  std::vector<int> not_others_;  // itself and what is present and conflicts with it
};

}  // namespace

Present first_interpretation(const detect::Candidates& candidates, const Overlaps& overlaps) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(),
                           [&](std::size_t i) { return candidates[i].probability; });
  Present present(candidates.size(), 0);
  for (const std::size_t i : order) {
    if (candidates[i].probability < kPresent) break;
    const bool free = std::ranges::none_of(overlaps[i], [&](const Overlap& overlap) {
      return overlap.conflicting && present[overlap.other] > 0;
    });
    if (free) present[i] = candidates[i].probability;
  }
  return present;
}

void measure_given_others(const SceneFeatures& scene, const Overlaps& overlaps,
                          const Present& present, detect::Candidates& candidates, double competing,
                          int num_threads) {
  const std::vector<int> owners = owners_of(scene, present, candidates);
  parallel_for(candidates.size(), num_threads, [&](std::size_t i) {
    detect::Candidate& candidate = candidates[i];
    if (candidate.score < competing) return;
    const Judge judge(scene, candidate, overlaps[i], present, i, owners);
    candidate.values[score::component("hidden_by_unknown")] = judge.hidden_by_unknown();
    candidate.values[score::component("left_over")] = judge.left_over();
    candidate.values[score::component("relative_exposure")] =
        judge.relative_exposure(candidates, present);
    candidate.values[score::component("copies")] = judge.copies(candidates, present);
  });
}

}  // namespace bpa::scene
