// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/matching.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace bpa::eval {

double right_cost(const Pose& estimate, const Pose& truth, const SymmetryGroup& symmetry,
                  double position_m, double angle_rad) {
  const PoseError error = pose_error(estimate, truth, symmetry, position_m, angle_rad);
  const double cost = std::max(error.position / position_m, error.angle / angle_rad);
  return cost <= 1 ? cost : kNoMatch;
}

bool is_right_about_any(const Pose& estimate, const ObjectModel& model,
                        const std::vector<io::BopInstance>& truth) {
  return std::ranges::any_of(truth, [&](const io::BopInstance& instance) {
    return instance.obj_id == model.number &&
           is_right(estimate, instance.camera_from_object, model.symmetry);
  });
}

std::vector<int> match_greedily(const std::vector<double>& scores,
                                const std::vector<std::vector<double>>& costs, double limit) {
  std::vector<std::size_t> order(scores.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t e) { return scores[e]; });
  std::vector<int> truth_of(scores.size(), -1);
  std::vector<bool> taken(costs.empty() ? 0 : costs.front().size(), false);
  for (const std::size_t e : order) {
    double best = limit;
    for (std::size_t t = 0; t < taken.size(); ++t) {
      if (taken[t] || !(costs[e][t] < best)) continue;
      best = costs[e][t];
      truth_of[e] = static_cast<int>(t);
    }
    if (truth_of[e] >= 0) taken[truth_of[e]] = true;
  }
  return truth_of;
}

}  // namespace bpa::eval
