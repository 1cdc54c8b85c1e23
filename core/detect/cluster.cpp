// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/align/align.hpp"
#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"
#include "core/geometry/tolerance.hpp"

namespace bpa::detect {
namespace {

constexpr std::ptrdiff_t kMaxCorrespondences = 10;  // that a cluster is aligned with
constexpr double kSuggestedShare = 0.25;            // of max_clusters, kept for poses of priors

// Candidates near the first, which is the best.
struct Cluster {
  Pose pose;
  std::vector<Candidate*> members;
};

std::vector<Cluster> group(const Search& search, Candidates& candidates) {
  std::vector<Cluster> clusters;
  for (Candidate& candidate : candidates) {
    const Pose& pose = candidate.pose();
    const auto found = std::ranges::find_if(clusters, [&](const Cluster& c) {
      const Eigen::Vector3d& centre = search.model.centre;
      if ((c.pose * centre - pose * centre).norm() > tolerance::kFarInCluster) return false;
      return within_tolerance(pose, c.pose, search.model.symmetry);
    });
    if (found != clusters.end()) {
      found->members.push_back(&candidate);
      search.reject("in the cluster of a better one", candidate.pose());
    } else {
      clusters.push_back({pose, {&candidate}});
    }
  }
  return clusters;
}

// BPA from the cluster's correspondences, those of its best members first. The best member where
// there are none.
Pose aligned_pose(const Search& search, const Cluster& cluster) {
  std::vector<align::OrientedPair> pairs;
  for (const Candidate* member : cluster.members) {
    if (std::ssize(pairs) == kMaxCorrespondences) break;
    if (member->scene_point >= 0) pairs.push_back(oriented_pair(search, *member));
  }
  if (pairs.empty()) return cluster.members.front()->pose();
  search.add_effort(&SearchEffort::alignments);
  return align::bpa_mode({.oriented = pairs}).camera_from_object;
}

// The best member, or the cluster aligned again where that scores better.
Candidate best_of(const Search& search, const Cluster& cluster) {
  Candidate best = *cluster.members.front();
  for (const Candidate* member : cluster.members) {
    if (!member->is_protected) continue;
    best.found_by = member->found_by;
    best.is_protected = true;
  }
  const double least = best.is_protected ? kNoLimit : search.plan.limits[score::Limit::clustered];
  const auto score = [&](const Pose& pose) {
    return search.quick_score(pose, kClusterRankPoints, least);
  };
  const Pose aligned = aligned_pose(search, cluster);
  best.score = score(best.pose());
  const double score_aligned = score(aligned);
  if (score_aligned > best.score) {
    best.refinement.frame_from_object = aligned;
    best.score = score_aligned;
  }
  return best;
}

// The best; some places are kept for what priors suggested.
void keep_clusters(const Search& search, Candidates& clusters) {
  const ClusterOptions& options = search.plan.cluster;
  const int most_suggested = static_cast<int>(kSuggestedShare * options.max_clusters);
  sort_by_score(clusters);
  Candidates suggested, others;
  for (Candidate& cluster : clusters) {
    const bool first = cluster.is_protected && std::ssize(suggested) < most_suggested;
    (first ? suggested : others).push_back(std::move(cluster));
  }
  keep_first(search, options.max_clusters - static_cast<int>(suggested.size()), others);
  clusters = std::move(suggested);
  std::ranges::move(others, std::back_inserter(clusters));
  sort_by_score(clusters);
}

}  // namespace

Candidates cluster(const Search& search, Candidates checked) {
  Candidates out;
  for (const Cluster& group_of_poses : group(search, checked)) {
    if (search.late()) break;
    Candidate& first = *group_of_poses.members.front();
    const bool few = std::ssize(group_of_poses.members) < search.plan.cluster.min_features;
    if (few && first.found_by == Source::feature) {
      search.reject("too few feature matches", first.pose());
    } else if (rejected_before(search, first)) {
      search.reject("scored low in an earlier round", first.pose());
    } else {
      out.push_back(best_of(search, group_of_poses));
    }
  }
  reject_below(search, score::Limit::clustered, out);
  keep_clusters(search, out);
  return out;
}

}  // namespace bpa::detect
