// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/pair_voting.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"
#include "core/cloud/neighbor_grid.hpp"

namespace bpa {
namespace {

constexpr int kTurnBins = 32;
constexpr int kStepsPerBin = kTurnSteps / kTurnBins;
constexpr int kMinVotes = 3;  // of a voted pose; chosen by hand

// The best turn of one model point: votes in a bin and the one after it.
struct Peak {
  int model_point = 0, bin = 0, votes = 0;
};

Peak best_turn(const std::uint16_t* bins, int model_point) {
  Peak best{model_point, 0, 0};
  for (int b = 0; b < kTurnBins; ++b) {
    const int votes = bins[b] + bins[(b + 1) % kTurnBins];
    if (votes > best.votes) best.bin = b, best.votes = votes;
  }
  return best;
}

// The middle of the two bins' votes, in radians.
float turn_between(const std::uint16_t* bins, int bin) {
  const float here = bins[bin];
  const float after = bins[(bin + 1) % kTurnBins];
  const float middle = static_cast<float>(bin) + after / std::max(1.0f, here + after);
  return (middle * kStepsPerBin + 0.5f * (kStepsPerBin - 1)) * (2 * 3.14159265f / kTurnSteps);
}

}  // namespace

ScenePairs scene_pairs(const PointCloud& cloud, std::vector<int> references, float reach,
                       int num_threads) {
  ScenePairs out;
  out.references = std::move(references);
  out.first.assign(out.references.size() + 1, 0);
  if (out.references.empty()) return out;
  const NeighborGrid grid(cloud.points, reach);
  std::vector<std::vector<ScenePairs::Partner>> partners(out.references.size());
  parallel_for(
      static_cast<int>(out.references.size()), num_threads,
      [&](int r) {
        const auto index = static_cast<std::size_t>(r);
        const auto i = static_cast<std::size_t>(out.references[index]);
        const Eigen::Matrix3f basis = basis_of(cloud.normals[i]);
        auto& own = partners[index];
        grid.for_each_neighbor(cloud.points[i], [&](int neighbor, float) {
          const auto j = static_cast<std::size_t>(neighbor);
          if (i == j || (i + j) % 2 != 0) return;  // half of them
          const PointPairFeature feature = point_pair_feature(cloud.points[i], cloud.normals[i],
                                                              cloud.points[j], cloud.normals[j]);
          if (!fixes_pose(feature)) return;
          own.push_back({feature.distance, pair_angle_key(feature),
                         turn_of(basis, cloud.points[j] - cloud.points[i])});
        });
        std::stable_sort(own.begin(), own.end(),
                         [](const auto& a, const auto& b) { return a.distance < b.distance; });
      },
      16);
  for (std::size_t r = 0; r < partners.size(); ++r) {
    out.partners.insert(out.partners.end(), partners[r].begin(), partners[r].end());
    out.first[r + 1] = static_cast<std::uint32_t>(out.partners.size());
  }
  return out;
}

std::vector<VotedPose> vote_poses(const ScenePairs& pairs, const PointPairTable& table,
                                  int num_model_points, int peaks) {
  std::vector<VotedPose> out;
  std::vector<std::uint16_t> votes(static_cast<std::size_t>(num_model_points) * kTurnBins);
  std::vector<Peak> best;
  for (std::size_t r = 0; r < pairs.references.size(); ++r) {
    std::fill(votes.begin(), votes.end(), std::uint16_t{0});
    for (std::uint32_t k = pairs.first[r]; k < pairs.first[r + 1]; ++k) {
      const ScenePairs::Partner& partner = pairs.partners[k];
      if (partner.distance > table.max_distance()) break;
      for (const auto& entry : table.lookup(partner.distance, partner.angle_key)) {
        const auto turn = static_cast<std::uint8_t>(partner.turn - entry.turn);
        ++votes[static_cast<std::size_t>(entry.point * kTurnBins + turn / kStepsPerBin)];
      }
    }
    best.clear();
    for (int i = 0; i < num_model_points; ++i) {
      const Peak peak = best_turn(&votes[static_cast<std::size_t>(i * kTurnBins)], i);
      if (peak.votes >= kMinVotes) best.push_back(peak);
    }
    const auto keep = std::min(best.size(), static_cast<std::size_t>(peaks));
    std::partial_sort(best.begin(), best.begin() + static_cast<std::ptrdiff_t>(keep), best.end(),
                      [](const Peak& a, const Peak& b) {
                        return a.votes != b.votes ? a.votes > b.votes
                                                  : a.model_point < b.model_point;
                      });
    for (std::size_t k = 0; k < keep; ++k) {
      const Peak& peak = best[k];
      out.push_back(
          {pairs.references[r], peak.model_point,
           turn_between(&votes[static_cast<std::size_t>(peak.model_point * kTurnBins)], peak.bin),
           peak.votes});
    }
  }
  return out;
}

}  // namespace bpa
