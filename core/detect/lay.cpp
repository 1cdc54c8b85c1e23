// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/model/model_index.hpp"
#include "core/score/predicted_surface.hpp"
#include "core/score/projected_block.hpp"
#include "core/score/silhouette_score.hpp"

namespace bpa::detect {
namespace {

// Chosen by hand on simulated tables, as all constants of this file.
constexpr double kSlideStep_m = tolerance::placed_m(3.2);  // first step at the object's rim
constexpr int kSlideRounds = 5;                            // of six steps each, on the plane
constexpr float kElongated = 1.4f;    // length over width; below, the longest direction says little
constexpr int kTurnsOfRound = 8;      // 45 degrees apart, where it says little
constexpr float kNearlyWhole = 0.8f;  // share of the length in sight
// With 0, 0.3, 0.4 and 0.5 the same 27/32 objects of YCB-Video and 149/204 of seed 777 are found.
constexpr double kMinOnRegion = 0.5;   // share of visible points; poses of less are not compared
constexpr float kEnds[] = {0, 1, -1};  // where a part in sight may be: middle, either end

Eigen::Matrix3f basis_along(const Eigen::Vector3f& axis, const Eigen::Vector3f& up) {
  Eigen::Matrix3f basis;
  basis << axis, up.cross(axis), up;
  return basis;
}

// True where a region may show the whole object at rest, or what something leaves of it.
bool may_show(const FlatRegion& region, const FlatRest& rest) {
  constexpr float kMoreLong = 1.2f, kMoreWide = 1.4f,
                  kMore = tolerance::placed(4);  // shadows, rims; metres
  constexpr float kLessLong = 0.4f, kLessWide = 0.3f;
  return region.length < kMoreLong * rest.length + kMore &&
         region.length > kLessLong * rest.length && region.width < kMoreWide * rest.width + kMore &&
         region.width > kLessWide * rest.width;
}

// The share of the model's visible pixels and the region's that both have.
double overlap(const Search& search, int region, const score::PredictedSurface& predicted) {
  const FlatRegions& flat = search.scene.flat;
  int both = 0, model = 0;
  predicted.for_each([&](int u, int v, float z, std::uint32_t) {
    const bool in_region = flat.label.at(u, v) == region;
    both += in_region;
    model += in_region || !search.scene.image.hides(search.scene.image.depth_at(u, v), z);
  });
  return both / std::max(1.0, static_cast<double>(flat.regions[region].pixels + model - both));
}

// Larger where the silhouette is the region's and its outline is seen in colour.
double agreement(const Search& search, int region, const Pose& pose) {
  const score::PredictedSurface predicted =
      score::predict_surface(search.scene.image, search.model, pose);
  const double contrast =
      score::compare_silhouette(search.scene.image, search.scene.gradients, predicted).contrast;
  return overlap(search, region, predicted) + (std::isnan(contrast) ? 0 : contrast);
}

// Of the model's visible points, the share that falls on a region, by a few points. Over all
// pixels it is at least overlap(), which takes about twenty times as long.
double share_on_region(const Search& search, int region, const FastPose& pose) {
  constexpr int kPoints = 64;  // as CheckOptions::points
  const CheckImage& image = search.scene.image;
  const CheckPoints& points = search.model.index->check;
  const int last = std::min(kPoints, static_cast<int>(points.points.size()));
  int on = 0, visible = 0;
  score::ProjectedBlock block;
  for (int first = 0; first < last; first += kCheckBlock) {
    block.project(image, points, pose, first);
    for (int k = 0; k < kCheckBlock; ++k) {
      if (block.pixel[k] < 0) continue;
      const auto pixel = static_cast<std::size_t>(block.pixel[k]);
      if (image.hides(image.pixels[pixel].depth, block.point[2][k])) continue;
      ++visible;
      on += search.scene.flat.label[pixel] == region;
    }
  }
  return on / std::max(1.0, static_cast<double>(visible));
}

// The model at rest on a region.
struct Resting {
  int region;
  Pose pose;
  double agreement;
};

void sort_by_agreement(std::vector<Resting>& poses) {
  std::ranges::stable_sort(poses, std::greater(), &Resting::agreement);
}

// The best `most` of sorted poses.
void keep_first(const Search& search, int most, std::vector<Resting>& poses) {
  if (std::ssize(poses) <= most) return;
  for (const Resting& one : std::span(poses).subspan(static_cast<std::size_t>(most))) {
    search.reject("better ones are enough", one.pose);
  }
  poses.resize(static_cast<std::size_t>(most));
}

// Sorts, and rejects duplicates of better poses.
void suppress_duplicates(const Search& search, std::vector<Resting>& poses) {
  sort_by_agreement(poses);
  std::vector<Resting> kept;
  for (const Resting& one : poses) {
    const bool seen = std::ranges::any_of(
        kept, [&](const Resting& other) { return duplicates(search, one.pose, other.pose); });
    if (seen) {
      search.reject("duplicate of a better one", one.pose);
    } else {
      kept.push_back(one);
    }
  }
  poses = std::move(kept);
}

// The ways in which the model may rest there.
void add_resting(const Search& search, int index, const FlatRest& rest, std::vector<Resting>& out) {
  const FlatRegion& region = search.scene.flat.regions[index];
  const bool elongated = rest.length > kElongated * rest.width;
  const int turns = elongated ? 2 : kTurnsOfRound;
  const bool whole = !elongated || region.length > kNearlyWhole * rest.length;
  const float hidden = (rest.length - region.length) / 2;
  for (int k = 0; k < turns && !search.late(); ++k) {
    const Eigen::AngleAxisf turn(static_cast<float>(2 * k * M_PI / turns), region.up);
    FastPose pose;
    pose.rotation =
        basis_along(turn * region.axis, region.up) * basis_along(rest.axis, rest.up).transpose();
    for (const float end : std::span(kEnds).first(whole ? 1 : 3)) {
      pose.translation = region.centre + end * hidden * region.axis - pose.rotation * rest.centre;
      if (share_on_region(search, index, pose) < kMinOnRegion) continue;
      const Pose camera_from_object = to_pose(pose);
      out.push_back({index, camera_from_object, agreement(search, index, camera_from_object)});
    }
  }
}

// The best of each region.
std::vector<Resting> resting_poses(const Search& search) {
  const FlatRegions& flat = search.scene.flat;
  std::vector<Resting> all;
  for (int index = 0; index < static_cast<int>(flat.regions.size()); ++index) {
    if (search.late()) break;
    std::vector<Resting> here;
    for (const FlatRest& rest : search.model.index->flat_rests) {
      if (may_show(flat.regions[index], rest)) add_resting(search, index, rest, here);
    }
    suppress_duplicates(search, here);
    keep_first(search, search.plan.lay.max_laid, here);
    std::ranges::move(here, std::back_inserter(all));
  }
  sort_by_agreement(all);
  keep_first(search, search.plan.lay.max_laid, all);
  return all;
}

// The three degrees of freedom that contact leaves: two steps along the plane, a turn about its
// normal; there and back.
Pose moved(const Search& search, int region, Pose pose, int move, double step) {
  const FlatRegion& flat = search.scene.flat.regions[region];
  const double sign = move % 2 ? -1 : 1;
  const Eigen::Vector3d up = flat.up.cast<double>(), axis = flat.axis.cast<double>();
  if (move < 4) {
    pose.translation += sign * step * (move < 2 ? axis : up.cross(axis));
    return pose;
  }
  const Eigen::Quaterniond turn =
      rotation_from_vector(sign * step / (0.5 * search.model.diameter) * up);
  const Eigen::Vector3d centre = pose * search.model.centre;
  pose.rotation = (turn * pose.rotation).normalized();
  pose.translation = centre - pose.rotation * search.model.centre;
  return pose;
}

// Small steps on the plane; smaller ones when none improves. Depth would drag the pose off it.
Pose slid(const Search& search, int region, Pose best) {
  double step = kSlideStep_m, best_agreement = agreement(search, region, best);
  for (int round = 0; round < kSlideRounds && !search.late(); ++round) {
    bool improved = false;
    for (int move = 0; move < 6; ++move) {
      const Pose pose = moved(search, region, best, move, step);
      const double here = agreement(search, region, pose);
      if (here <= best_agreement) continue;
      best = pose;
      best_agreement = here;
      improved = true;
    }
    if (!improved) step *= 0.5;
  }
  return best;
}

}  // namespace

Candidates lay(const Search& whole, Candidates found) {
  const bool thin = !whole.model.index->flat_rests.empty();
  if (!thin || !whole.scene.with_flat || whole.plan.lay.max_laid == 0) return found;
  const Search search(*whole.scene.with_flat, whole);
  Candidates laid;
  for (const Resting& resting : resting_poses(search)) {
    laid.push_back({.model = &search.model,
                    .refinement = {resting.pose},
                    .found_by = Source::region,
                    .scene_point = resting.region,
                    .score = search.quick_score(resting.pose, kClusterRankPoints)});
  }
  reject_below(search, score::Limit::laid, laid);
  change_each(search, laid, [&](Candidate& candidate) {
    const Pose pose = slid(search, candidate.scene_point, candidate.pose());
    candidate = search.scored(candidate, search.measured(pose));
  });
  std::ranges::move(laid, std::back_inserter(found));
  whole.effort += search.effort;
  return found;
}

}  // namespace bpa::detect
