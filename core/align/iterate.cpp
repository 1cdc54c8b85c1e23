// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/align/iterate.hpp"

namespace bpa::align {

IterationResult iterate(const Pose& start, const MatchFunction& match,
                        const IterationOptions& options) {
  IterationResult result;
  result.estimate.camera_from_object = start;
  Matches matches;
  while (static_cast<int>(result.poses.size()) < options.max_iterations) {
    const Pose before = result.estimate.camera_from_object;
    matches.oriented.clear();
    matches.positions.clear();
    match(before, matches);
    const std::size_t count = matches.oriented.size() + matches.positions.size();
    if (count < static_cast<std::size_t>(options.min_matches)) {
      result.poses.push_back(before);  // The next matches may be others.
      continue;
    }
    const Correspondences data{.oriented = matches.oriented, .positions = matches.positions};
    result.estimate = options.method == Method::bpa ? bpa_mode(data) : icp_mode(data);
    const Pose& after = result.estimate.camera_from_object;
    result.poses.push_back(after);
    const double moved = (after.translation - before.translation).norm();
    const double turned = rotation_angle(after.rotation, before.rotation);
    result.converged = moved < options.position_tol_m && turned < options.angle_tol_rad;
    if (result.converged) break;
  }
  return result;
}

}  // namespace bpa::align
