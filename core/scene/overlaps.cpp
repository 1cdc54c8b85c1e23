// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <bpa/core/scene/overlaps.hpp>

namespace bpa {
namespace {

// Two solid things cannot have nearly the same place.
bool same_place(const Candidate& a, const Candidate& b) {
  const double distance = (a.pose().translation - b.pose().translation).norm();
  const double smaller = std::min(a.model->diameter, b.model->diameter);
  return distance < (a.model == b.model ? 0.4 : 0.2) * smaller;
}

bool same_pose(const Candidate& a, const Candidate& b) {
  if (a.model != b.model || (a.pose().translation - b.pose().translation).norm() > 0.1)
    return false;
  const PoseError error = pose_error(a.pose(), b.pose(), a.model->symmetry);
  return error.position < 0.025 && error.angle < M_PI / 16;
}

// Counts through an index from pixels to the candidates that explain them.
std::vector<int> common_pixels(const std::vector<Candidate>& candidates) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> by_pixel;
  for (std::uint32_t i = 0; i < candidates.size(); ++i) {
    for (std::uint32_t pixel : candidates[i].explained) by_pixel.push_back({pixel, i});
  }
  std::sort(by_pixel.begin(), by_pixel.end());
  const std::size_t count = candidates.size();
  std::vector<int> common(count * count, 0);
  for (std::size_t first = 0; first < by_pixel.size();) {
    std::size_t last = first;
    while (last < by_pixel.size() && by_pixel[last].first == by_pixel[first].first) ++last;
    for (std::size_t a = first; a < last; ++a) {
      for (std::size_t b = first; b < last; ++b) {
        ++common[by_pixel[a].second * count + by_pixel[b].second];
      }
    }
    first = last;
  }
  return common;
}

}  // namespace

std::vector<std::vector<Overlap>> find_overlaps(const std::vector<Candidate>& candidates,
                                                double max_shared) {
  const std::vector<int> common = common_pixels(candidates);
  const std::size_t count = candidates.size();
  std::vector<std::vector<Overlap>> overlaps(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      if (i == j) continue;
      const int shared = common[i * count + j];
      const bool colliding = same_place(candidates[i], candidates[j]);
      if (shared == 0 && !colliding) continue;
      const auto smaller = static_cast<double>(
          std::min(candidates[i].explained.size(), candidates[j].explained.size()));
      overlaps[i].push_back(
          {static_cast<std::uint32_t>(j), shared, colliding || shared > max_shared * smaller});
    }
  }
  return overlaps;
}

Competition competition_of(const std::vector<Candidate>& candidates,
                           const std::vector<std::vector<Overlap>>& overlaps) {
  Competition out;
  out.rivals.resize(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (const Overlap& overlap : overlaps[i]) {
      if (!overlap.conflicting) continue;
      out.rivals[i].push_back({overlap.other, same_pose(candidates[i], candidates[overlap.other])});
    }
  }
  return out;
}

}  // namespace bpa
