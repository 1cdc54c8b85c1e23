// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/search_yield.hpp"

#include <algorithm>
#include <cstddef>

namespace bpa::score {
namespace {

constexpr std::size_t kFewestDiscoveries = 50;

double log_likelihood(const std::vector<Discovery>& discoveries, const SearchYield& yield) {
  constexpr double kLeast = 1e-12;
  double sum = 0;
  for (const Discovery& one : discoveries) {
    const double between = yield.undiscovered(one.after) - yield.undiscovered(one.at_most);
    sum += std::log(std::max(kLeast, between));
  }
  return sum;
}

// By grids of falling steps in the logarithms of both.
void fit_tries(const std::vector<Discovery>& discoveries, SearchYield& yield) {
  yield.shape = yield.tries = 1;
  constexpr int kToEachSide = 4;
  for (double step = 1; step > 0.01; step /= 2) {
    SearchYield best = yield;
    double most = log_likelihood(discoveries, best);
    for (int i = -kToEachSide; i <= kToEachSide; ++i) {
      for (int k = -kToEachSide; k <= kToEachSide; ++k) {
        SearchYield tried = yield;
        tried.shape *= std::exp(step * i);
        tried.tries *= std::exp(step * k);
        const double now = log_likelihood(discoveries, tried);
        if (now <= most) continue;
        most = now;
        best = tried;
      }
    }
    yield = best;
  }
}

}  // namespace

SearchYield measure_yield(const std::vector<Discovery>& discoveries,
                          const std::vector<int>& objects_in_frames, const SearchYield& start) {
  if (discoveries.size() < kFewestDiscoveries) return start;
  SearchYield out;
  fit_tries(discoveries, out);
  double visible = 0;
  for (const Discovery& one : discoveries) visible += one.visible;
  out.visible = std::min(1.0, visible / static_cast<double>(discoveries.size()));
  const auto frames = static_cast<double>(objects_in_frames.size());
  double mean = 0, variance = 0;
  for (const int objects : objects_in_frames) mean += objects / frames;
  for (const int objects : objects_in_frames) variance += std::pow(objects - mean, 2) / frames;
  // A gamma distribution of means makes Poisson counts vary by mean + mean^2 / objects.
  out.scenes = std::min(frames, mean / std::max(1e-9, variance - mean));
  out.objects = mean * out.scenes;
  return out;
}

}  // namespace bpa::score
