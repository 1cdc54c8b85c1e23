// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <bpa/core/align/align.hpp>
#include <bpa/core/base/random.hpp>
#include <bpa/core/cloud/neighbor_grid.hpp>
#include <bpa/core/detect/hypotheses.hpp>
#include <bpa/core/model/model_index.hpp>

namespace bpa {
namespace {

CheckTolerance loose_tolerance(const ObjectModel& model) {
  CheckTolerance tolerance;
  tolerance.depth = std::clamp(0.05f * static_cast<float>(model.diameter), 0.006f, 0.015f);
  tolerance.free_depth = 0.03f;
  tolerance.normal_cosine = 0.7f;
  return tolerance;
}

align::OrientedPoint oriented_point(const PointCloud& cloud, int index, bool with_curvature) {
  const auto i = static_cast<std::size_t>(index);
  align::OrientedPoint out;
  out.point = cloud.points[i].cast<double>();
  const Eigen::Vector3d normal = cloud.normals[i].cast<double>();
  if (with_curvature) {
    out.orientation =
        align::feature_orientation(normal, cloud.principal_directions[i].cast<double>());
    out.lambda3 = align::curvature_concentration(cloud.curvatures[i].x(), cloud.curvatures[i].y());
  } else {
    out.orientation = align::feature_orientation(normal);
  }
  return out;
}

double position_sigma(const Eigen::Vector3d& scene_point, float spacing) {
  return spacing + static_cast<double>(depth_noise(static_cast<float>(scene_point.z())));
}

align::OrientedPair oriented_pair(const SceneFeatures& scene, const ModelIndex& model,
                                  int scene_index, int model_index, bool feature) {
  align::OrientedPair pair;
  pair.scene = oriented_point(feature ? scene.surface : scene.coarse, scene_index, feature);
  pair.model = oriented_point(feature ? model.features : model.coarse, model_index, feature);
  pair.sigma = position_sigma(pair.scene.point, feature ? 0.004f : 0.008f);
  return pair;
}

// The pose that lays one pair of oriented points on another: the frames of their lines and mean
// normals.
bool pose_of_pair(const Eigen::Vector3f& p1, const Eigen::Vector3f& n1, const Eigen::Vector3f& p2,
                  const Eigen::Vector3f& n2, Eigen::Matrix3f& frame) {
  const Eigen::Vector3f x = (p2 - p1).normalized();
  Eigen::Vector3f up = n1 + n2;
  up -= x * x.dot(up);
  const float norm = up.norm();
  if (norm < 0.2f) {
    up = n1 - x * x.dot(n1);
    if (up.norm() < 0.2f) return false;
  }
  up.normalize();
  frame.col(0) = x;
  frame.col(1) = up;
  frame.col(2) = x.cross(up);
  return true;
}

class Sampler {
 public:
  Sampler(const SceneFeatures& scene, const ObjectModel& model, const HypothesisOptions& options)
      : scene_(scene),
        model_(model),
        options_(options),
        tolerance_(loose_tolerance(model)),
        random_(options.seed, static_cast<std::uint64_t>(model.number)) {}

  void from_features() {
    const ModelIndex& index = *model_.index;
    const auto matches = index.feature_tree.nearest(scene_.fpfh, options_.matches_per_keypoint, 1);
    for (std::size_t k = 0; k < matches.size(); ++k) {
      if (matches[k].index < 0) continue;
      Hypothesis hypothesis;
      hypothesis.scene =
          scene_.keypoints[k / static_cast<std::size_t>(options_.matches_per_keypoint)];
      hypothesis.model = matches[k].index;
      const align::OrientedPair pair =
          oriented_pair(scene_, index, hypothesis.scene, hypothesis.model, true);
      for (int draw = 0; draw < options_.draws_per_match; ++draw) {
        hypothesis.camera_from_object = to_fast(align::bpa_sample_one(pair, random_));
        consider(hypothesis);
      }
    }
  }

  void from_pairs() {
    const int count = static_cast<int>(scene_.coarse.size());
    if (count < 2) return;
    const auto reach =
        std::min(model_.index->pairs.max_distance(), 0.9f * static_cast<float>(model_.diameter));
    const NeighborGrid grid(scene_.coarse.points, reach);
    std::vector<int> partners;
    const int per_point = 8;
    for (int draw = 0; draw < options_.pair_draws / per_point; ++draw) {
      const int first = random_.index(count);
      partners.clear();
      grid.for_each_neighbor(scene_.coarse.points[static_cast<std::size_t>(first)],
                             [&](int j, float squared) {
                               if (squared > 0.04f * reach * reach) partners.push_back(j);
                             });
      if (partners.empty()) continue;
      for (int k = 0; k < per_point; ++k) {
        from_pair(
            first,
            partners[static_cast<std::size_t>(random_.index(static_cast<int>(partners.size())))]);
      }
    }
  }

  std::vector<Hypothesis> take() {
    const auto keep = static_cast<std::size_t>(options_.max_kept);
    std::stable_sort(kept_.begin(), kept_.end(),
                     [](const auto& a, const auto& b) { return a.score > b.score; });
    if (kept_.size() > keep) kept_.resize(keep);
    return std::move(kept_);
  }

 private:
  void from_pair(int first, int second) {
    const PointCloud& cloud = scene_.coarse;
    const auto i = static_cast<std::size_t>(first);
    const auto j = static_cast<std::size_t>(second);
    const PointPairFeature feature =
        point_pair_feature(cloud.points[i], cloud.normals[i], cloud.points[j], cloud.normals[j]);
    if (!PointPairTable::informative(feature)) return;
    const auto candidates = model_.index->pairs.lookup(feature);
    if (candidates.empty()) return;
    Eigen::Matrix3f scene_frame;
    if (!pose_of_pair(cloud.points[i], cloud.normals[i], cloud.points[j], cloud.normals[j],
                      scene_frame)) {
      return;
    }
    const Eigen::Vector3f scene_middle = 0.5f * (cloud.points[i] + cloud.points[j]);
    const PointCloud& coarse = model_.index->coarse;
    const int available = static_cast<int>(candidates.size());
    const int tries = std::min(available, options_.max_matches_per_pair);
    for (int k = 0; k < tries; ++k) {
      const auto& [a, b] =
          candidates[static_cast<std::size_t>(tries < available ? random_.index(available) : k)];
      Eigen::Matrix3f model_frame;
      if (!pose_of_pair(coarse.points[a], coarse.normals[a], coarse.points[b], coarse.normals[b],
                        model_frame)) {
        continue;
      }
      Hypothesis hypothesis;
      hypothesis.scene = first, hypothesis.second_scene = second;
      hypothesis.model = a, hypothesis.second_model = b;
      FastPose& pose = hypothesis.camera_from_object;
      pose.rotation = scene_frame * model_frame.transpose();
      pose.translation =
          scene_middle - pose.rotation * (0.5f * (coarse.points[a] + coarse.points[b]));
      consider(hypothesis);
    }
  }

  void consider(Hypothesis& hypothesis) {
    const PoseCheck check =
        check_pose(scene_.image, model_.index->check, hypothesis.camera_from_object,
                   options_.check_points, tolerance_);
    // Paper section V: more than 20 % of the points in free space rejects the pose.
    if (5 * check.free_space > check.seen || check.seen < 6) return;
    hypothesis.score = check.score();
    if (hypothesis.score < static_cast<float>(options_.min_check_score)) return;
    kept_.push_back(hypothesis);
    if (kept_.size() >= 8 * static_cast<std::size_t>(options_.max_kept)) kept_ = take();
  }

  const SceneFeatures& scene_;
  const ObjectModel& model_;
  const HypothesisOptions& options_;
  CheckTolerance tolerance_;
  RandomStream random_;
  std::vector<Hypothesis> kept_;
};

struct Cluster {
  Pose pose;
  std::vector<std::size_t> members;
};

int correspondences_of(const Hypothesis& hypothesis) { return hypothesis.second_scene < 0 ? 1 : 2; }

// BPA from the cluster's correspondences, up to ten of them, those of its best members first.
Pose align_cluster(const SceneFeatures& scene, const ObjectModel& model,
                   const std::vector<Hypothesis>& hypotheses, const Cluster& cluster) {
  align::OrientedPair pairs[10];
  std::size_t count = 0;
  for (std::size_t member : cluster.members) {
    const Hypothesis& h = hypotheses[member];
    const bool feature = h.second_scene < 0;
    if (count + 2 > 10) break;
    pairs[count++] = oriented_pair(scene, *model.index, h.scene, h.model, feature);
    if (!feature) {
      pairs[count++] = oriented_pair(scene, *model.index, h.second_scene, h.second_model, false);
    }
  }
  align::Correspondences data;
  data.oriented = std::span<const align::OrientedPair>(pairs, count);
  return align::bpa_mode(data).camera_from_object;
}

}  // namespace

std::vector<Hypothesis> sample_hypotheses(const SceneFeatures& scene, const ObjectModel& model,
                                          const HypothesisOptions& options) {
  Sampler sampler(scene, model, options);
  sampler.from_features();
  sampler.from_pairs();
  return sampler.take();
}

std::vector<Hypothesis> cluster_hypotheses(const SceneFeatures& scene, const ObjectModel& model,
                                           const std::vector<Hypothesis>& hypotheses,
                                           int max_clusters) {
  constexpr double kPosition = 0.025;
  constexpr double kAngle = M_PI / 16;
  std::vector<Cluster> clusters;
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    const Pose pose = to_pose(hypotheses[h].camera_from_object);
    const auto found = std::find_if(clusters.begin(), clusters.end(), [&](const Cluster& c) {
      if ((c.pose.translation - pose.translation).norm() > 3 * kPosition) return false;
      const PoseError error = pose_error(pose, c.pose, model.symmetry);
      return error.position < kPosition && error.angle < kAngle;
    });
    if (found != clusters.end()) {
      found->members.push_back(h);
    } else {
      clusters.push_back({pose, {h}});
    }
  }
  std::erase_if(clusters, [&](const Cluster& cluster) {
    return cluster.members.size() < 2 && correspondences_of(hypotheses[cluster.members[0]]) < 2;
  });
  const CheckTolerance tolerance = loose_tolerance(model);
  std::vector<Hypothesis> out;
  for (const Cluster& cluster : clusters) {
    Hypothesis best = hypotheses[cluster.members.front()];
    best.score =
        check_pose(scene.image, model.index->check, best.camera_from_object, 256, tolerance)
            .score();
    const FastPose aligned = to_fast(align_cluster(scene, model, hypotheses, cluster));
    const float score =
        check_pose(scene.image, model.index->check, aligned, 256, tolerance).score();
    if (score > best.score) best.camera_from_object = aligned, best.score = score;
    out.push_back(best);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  if (out.size() > static_cast<std::size_t>(max_clusters)) {
    out.resize(static_cast<std::size_t>(max_clusters));
  }
  return out;
}

}  // namespace bpa
