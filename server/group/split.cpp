// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/split.hpp"

#include <algorithm>

namespace bpa::server::group {
namespace {

constexpr double kOfNew = 0.2;  // weight of one more measurement; by hand

void move_towards(double measured, double& value) { value += kOfNew * (measured - value); }

}  // namespace

void SearchCost::add(const SearchCost& measured) {
  move_towards(measured.preparation_ms, preparation_ms);
  move_towards(measured.ms_a_model, ms_a_model);
  move_towards(measured.exchange_ms, exchange_ms);
}

std::size_t workers_for_frame(const SearchCost& cost, std::size_t models, std::size_t frames,
                              std::size_t workers) {
  frames = std::max<std::size_t>(frames, 1);
  std::size_t best = 1;
  double best_ms = 0;
  for (std::size_t some = 1; some <= std::max<std::size_t>(workers, 1); ++some) {
    const std::size_t at_once = std::max<std::size_t>(workers / some, 1);
    const auto turns = static_cast<double>((frames + at_once - 1) / at_once);
    const double last_ms = turns * cost.milliseconds(models, some);
    if (some > 1 && last_ms >= best_ms) continue;
    best = some;
    best_ms = last_ms;
  }
  return best;
}

std::vector<std::size_t> split_models(std::size_t models, const std::vector<double>& pace) {
  std::vector<double> busy_ms(pace.size(), 0);
  std::vector<std::size_t> worker_of(models);
  for (std::size_t& chosen : worker_of) {
    chosen = 0;
    for (std::size_t w = 1; w < pace.size(); ++w) {
      if (busy_ms[w] + pace[w] < busy_ms[chosen] + pace[chosen]) chosen = w;
    }
    busy_ms[chosen] += pace[chosen];
  }
  return worker_of;
}

}  // namespace bpa::server::group
