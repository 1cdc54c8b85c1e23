// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/split.hpp"

#include <algorithm>

namespace bpa::server::group {
std::size_t workers_for_frame(std::size_t frames, std::size_t workers) {
  return std::max<std::size_t>(workers / std::max<std::size_t>(frames, 1), 1);
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
