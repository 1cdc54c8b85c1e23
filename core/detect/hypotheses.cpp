// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/align/align.hpp"
#include "core/base/random.hpp"
#include "core/base/stopwatch.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/detect/refinement.hpp"
#include "core/model/model_index.hpp"

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

void sort_by_score(std::vector<Hypothesis>& all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.score > b.score; });
}

// The cube, of which `per_metre` make a metre, that a place lies in.
std::uint64_t place_cell(const Eigen::Vector3f& place, float per_metre) {
  const Eigen::Vector3i cell = (place * per_metre).array().floor().cast<int>() + 512;
  return static_cast<std::uint64_t>(cell.x() & 1023) << 20 |
         static_cast<std::uint64_t>(cell.y() & 1023) << 10 |
         static_cast<std::uint64_t>(cell.z() & 1023);
}

// The best, and those of each place in the scene: an object that is easily mistaken for this one
// must not crowd out a place where the fit is worse but true. Each better one within the same 5 cm
// costs `rank_penalty` of the score. Leaves them sorted by score.
void keep_best(std::vector<Hypothesis>& all, int count, float rank_penalty, DroppedPoses* dropped) {
  sort_by_score(all);
  if (all.size() <= static_cast<std::size_t>(count)) return;
  std::unordered_map<std::uint64_t, int> met;
  std::vector<std::pair<float, std::size_t>> order;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const int rank = met[place_cell(all[i].camera_from_object.translation, 20)]++;
    order.push_back({-all[i].score + rank_penalty * static_cast<float>(rank), i});
  }
  std::stable_sort(order.begin(), order.end());
  for (auto o = order.begin() + count; o != order.end(); ++o) {
    drop(dropped, "better ones are enough", all[o->second].camera_from_object);
  }
  order.resize(static_cast<std::size_t>(count));
  std::vector<Hypothesis> kept;
  for (const auto& [penalised, i] : order) kept.push_back(all[i]);
  sort_by_score(kept);
  all = std::move(kept);
}

class Sampler {
 public:
  Sampler(const SceneFeatures& scene, const ObjectModel& model, const HypothesisOptions& options,
          SamplingTrace* trace)
      : scene_(scene),
        model_(model),
        options_(options),
        trace_(trace),
        dropped_(trace ? &trace->dropped : nullptr),
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
    const ModelIndex& index = *model_.index;
    const auto count = static_cast<int>(index.coarse.size());
    std::vector<Eigen::Matrix3f> bases;
    for (const Eigen::Vector3f& normal : index.coarse.normals) bases.push_back(basis_of(normal));
    for (const VotedPose& voted :
         vote_poses(scene_.pairs, index.pairs, count, options_.peaks_per_reference)) {
      const auto s = static_cast<std::size_t>(voted.reference);
      const auto m = static_cast<std::size_t>(voted.model_point);
      Hypothesis hypothesis;
      hypothesis.source = Hypothesis::Source::pairs;
      hypothesis.scene = voted.reference;
      hypothesis.model = voted.model_point;
      FastPose& pose = hypothesis.camera_from_object;
      pose.rotation = basis_of(scene_.coarse.normals[s]) *
                      Eigen::AngleAxisf(voted.turn, Eigen::Vector3f::UnitZ()) *
                      bases[m].transpose();
      pose.translation = scene_.coarse.points[s] - pose.rotation * index.coarse.points[m];
      consider(hypothesis);
    }
  }

  // A pose that the caller suggests is as far off as the caller is unsure, and the surface may be
  // nearer than the checks allow for: it is looked at as it is and aligned.
  void from_caller() {
    RefinementOptions wide;
    wide.iterations = 4;
    wide.max_points = 100;
    wide.max_edges = options_.use_edges ? 30 : 0;
    wide.start_gate_m = 0.050f;
    wide.end_gate_m = 0.015f;
    for (const Pose& pose : options_.suggested) {
      Hypothesis hypothesis;
      hypothesis.source = Hypothesis::Source::caller;
      for (const Pose& start : {pose, refine_pose(scene_, model_, pose, wide).camera_from_object}) {
        hypothesis.camera_from_object = to_fast(start);
        if (passes(hypothesis)) suggested_.push_back(hypothesis);
      }
    }
    keep_best(suggested_, options_.max_suggested, kRankPenalty, dropped_);
  }

  // Looks again at everything that was kept, with more points, after a first small correction.
  std::vector<Hypothesis> take() {
    const Stopwatch watch;
    std::vector<std::pair<std::uint64_t, const PoseCell*>> cells;
    for (const auto& [key, cell] : cells_) cells.push_back({key, &cell});
    std::sort(cells.begin(), cells.end());
    std::vector<Hypothesis> kept;
    for (const auto& [key, cell] : cells) {
      kept.insert(kept.end(), cell->members, cell->members + cell->count);
    }
    keep_best(kept, 2 * options_.max_kept, kRankPenalty, dropped_);
    for (Hypothesis& hypothesis : kept) correct(hypothesis);
    keep_best(kept, options_.max_kept, kRankPenalty, dropped_);
    for (Hypothesis& hypothesis : suggested_) correct(hypothesis);
    kept.insert(kept.end(), suggested_.begin(), suggested_.end());
    sort_by_score(kept);
    if (trace_) trace_->check_milliseconds += watch.milliseconds();
    return kept;
  }

 private:
  void consider(Hypothesis& hypothesis) {
    if (passes(hypothesis)) keep(hypothesis);
  }

  // Checks and scores it; says in the trace what was looked at, and why it was dropped.
  bool passes(Hypothesis& hypothesis) {
    if (!trace_) return check(hypothesis);
    trace_->considered.push_back(hypothesis.camera_from_object);
    const Stopwatch watch;
    const bool passed = check(hypothesis);
    trace_->check_milliseconds += watch.milliseconds();
    return passed;
  }

  bool check(Hypothesis& hypothesis) {
    const FastPose& pose = hypothesis.camera_from_object;
    PoseCheck check =
        check_pose(scene_.image, model_.index->check, pose, options_.check_points, tolerance_);
    // Where most of the object is hidden, the few points in sight are too few to judge by.
    if (check.seen < kFewSeen && check.agreeing > 0 && 2 * check.free_space <= check.seen) {
      check = check_pose(scene_.image, model_.index->check, pose, options_.hidden_check_points,
                         tolerance_);
    }
    hypothesis.score = check.score();
    // Paper section V: more than 20 % of the points in free space rejects the pose.
    if (5 * check.free_space > check.seen) {
      drop(dropped_, "over 20 % in free space", pose);
    } else if (check.seen < 6) {
      drop(dropped_, "fewer than 6 points in sight", pose);
    } else if (hypothesis.score < static_cast<float>(options_.min_check_score)) {
      drop(dropped_, "not on the surface", pose);
    } else {
      return true;
    }
    return false;
  }

  // A sampled pose is off by as much as the sampling of both surfaces is coarse.
  void correct(Hypothesis& hypothesis) const {
    RefinementOptions small;
    small.iterations = 2;
    small.max_points = 64;
    small.max_edges = options_.use_edges ? 24 : 0;
    small.start_gate_m = 0.020f;
    small.end_gate_m = 0.012f;
    const FastPose corrected =
        to_fast(refine_pose(scene_, model_, to_pose(hypothesis.camera_from_object), small)
                    .camera_from_object);
    const auto check = [&](const FastPose& pose) {
      return check_pose(scene_.image, model_.index->check, pose, 256, tolerance_).score();
    };
    hypothesis.score = check(hypothesis.camera_from_object);
    const float score = check(corrected);
    if (score > hypothesis.score) {
      hypothesis.camera_from_object = corrected;
      hypothesis.score = score;
    }
  }

  // The best few of each pose cell, so that an easy object does not crowd out a hard one.
  void keep(const Hypothesis& hypothesis) {
    PoseCell& cell = cells_[pose_cell(hypothesis.camera_from_object)];
    if (cell.count < kPerCell) {
      cell.members[cell.count++] = hypothesis;
      return;
    }
    Hypothesis* worst = std::min_element(
        cell.members, cell.members + kPerCell,
        [](const Hypothesis& a, const Hypothesis& b) { return a.score < b.score; });
    const bool better = hypothesis.score > worst->score;
    drop(dropped_, "better ones beside it", (better ? *worst : hypothesis).camera_from_object);
    if (better) *worst = hypothesis;
  }

  // Cells of 25 mm and about 25 degrees; of an object that may be turned about an axis, the turn
  // does not count.
  std::uint64_t pose_cell(const FastPose& pose) const {
    std::uint64_t key = place_cell(pose.translation, 40);
    const auto add_direction = [&key](const Eigen::Vector3f& direction) {
      const Eigen::Vector3i cell = ((direction.array() + 1) * 2.5f).floor().cast<int>();
      key = key * 216 + static_cast<std::uint64_t>(cell.x() + 6 * cell.y() + 36 * cell.z());
    };
    if (model_.symmetry.continuous.empty()) {
      add_direction(pose.rotation.col(0));
      add_direction(pose.rotation.col(1));
    } else {
      add_direction(pose.rotation * model_.symmetry.continuous.front().axis.cast<float>());
    }
    return key;
  }

  static constexpr int kPerCell = 3;
  static constexpr int kFewSeen = 20;
  static constexpr float kRankPenalty = 0.02f;
  struct PoseCell {
    int count = 0;
    Hypothesis members[kPerCell];
  };

  const SceneFeatures& scene_;
  const ObjectModel& model_;
  const HypothesisOptions& options_;
  SamplingTrace* trace_;
  DroppedPoses* dropped_;
  CheckTolerance tolerance_;
  RandomStream random_;
  std::unordered_map<std::uint64_t, PoseCell> cells_;
  std::vector<Hypothesis> suggested_;
};

struct Cluster {
  Pose pose;
  std::vector<std::size_t> members;
};

// BPA from the cluster's correspondences, up to ten of them, those of its best members first. The
// best member where there are none, since the caller suggested all.
Pose align_cluster(const SceneFeatures& scene, const ObjectModel& model,
                   const std::vector<Hypothesis>& hypotheses, const Cluster& cluster) {
  align::OrientedPair pairs[10];
  std::size_t count = 0;
  for (std::size_t member : cluster.members) {
    if (count == 10) break;
    const Hypothesis& h = hypotheses[member];
    if (h.source == Hypothesis::Source::caller) continue;
    pairs[count++] = oriented_pair(scene, *model.index, h.scene, h.model,
                                   h.source == Hypothesis::Source::feature);
  }
  if (count == 0) return to_pose(hypotheses[cluster.members.front()].camera_from_object);
  align::Correspondences data;
  data.oriented = std::span<const align::OrientedPair>(pairs, count);
  return align::bpa_mode(data).camera_from_object;
}

// The best `count`; a quarter of the places is for those with the caller's suggestions.
void keep_clusters(std::vector<Hypothesis>& clusters, int count, DroppedPoses* dropped) {
  constexpr float kRankPenalty = 0.04f;
  sort_by_score(clusters);
  std::vector<Hypothesis> suggested, others;
  for (const Hypothesis& cluster : clusters) {
    const bool first = cluster.source == Hypothesis::Source::caller &&
                       suggested.size() < static_cast<std::size_t>(count) / 4;
    (first ? suggested : others).push_back(cluster);
  }
  keep_best(others, count - static_cast<int>(suggested.size()), kRankPenalty, dropped);
  clusters = std::move(suggested);
  clusters.insert(clusters.end(), others.begin(), others.end());
  sort_by_score(clusters);
}

}  // namespace

std::vector<Hypothesis> sample_hypotheses(const SceneFeatures& scene, const ObjectModel& model,
                                          const HypothesisOptions& options, SamplingTrace* trace) {
  Sampler sampler(scene, model, options, trace);
  sampler.from_features();
  sampler.from_pairs();
  sampler.from_caller();
  return sampler.take();
}

std::vector<Hypothesis> cluster_hypotheses(const SceneFeatures& scene, const ObjectModel& model,
                                           const std::vector<Hypothesis>& hypotheses,
                                           int max_clusters, DroppedPoses* dropped) {
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
      drop(dropped, "in the group of a better one", hypotheses[h].camera_from_object);
    } else {
      clusters.push_back({pose, {h}});
    }
  }
  std::erase_if(clusters, [&](const Cluster& cluster) {
    // A voted pose stands for many pairs.
    const Hypothesis& first = hypotheses[cluster.members.front()];
    const bool alone = cluster.members.size() < 2 && first.source == Hypothesis::Source::feature;
    if (alone) drop(dropped, "one feature match alone", first.camera_from_object);
    return alone;
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
    for (std::size_t member : cluster.members) {
      if (hypotheses[member].source == Hypothesis::Source::caller)
        best.source = Hypothesis::Source::caller;
    }
    out.push_back(best);
  }
  keep_clusters(out, max_clusters, dropped);
  return out;
}

}  // namespace bpa
