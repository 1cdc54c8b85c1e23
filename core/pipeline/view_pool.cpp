// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/view_pool.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/parallel.hpp"
#include "core/detect/exclusion.hpp"
#include "core/detect/stages.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/scene/given_others.hpp"
#include "core/scene/interpretations.hpp"

namespace bpa {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Log odds of what a view does not see at all: no stage looks at it there.
constexpr double kNotSeen = std::numeric_limits<double>::lowest();
// Of the largest part that any view shows of a placement: a view that shows less does not decide
// whether two placements exclude one another. Chosen by hand.
constexpr double kDecidingShare = 0.25;

double visibility_of(const detect::Candidate& candidate) {
  const double value = candidate.values[score::component("visibility")];
  return std::isnan(value) ? 0 : value;
}

// The information of a pose about other axes.
Matrix6 turned(const Eigen::Matrix3d& rotation, const Matrix6& information) {
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = rotation;
  return turn * information * turn.transpose();
}

// What is left of the information of a pose where the camera's own pose is uncertain.
Matrix6 with_camera_error(const Matrix6& information, double distance,
                          const ViewsOptions& options) {
  constexpr double kNothingKnown = 1e-6;  // keeps the inverse finite
  const double angle = options.angle_sigma_deg * std::numbers::pi / 180;
  Matrix6 covariance =
      (information / tolerance::kCorrelatedPoints + kNothingKnown * Matrix6::Identity()).inverse();
  covariance.diagonal().head<3>().array() +=
      options.position_sigma_m * options.position_sigma_m + angle * angle * distance * distance;
  covariance.diagonal().tail<3>().array() += angle * angle;
  return tolerance::kCorrelatedPoints * covariance.inverse();
}

std::size_t most_explained(const detect::Candidates& in_view) {
  std::size_t most = 0;
  for (const detect::Candidate& candidate : in_view)
    most = std::max(most, candidate.explained.size());
  return most;
}

}  // namespace

struct ViewPool::Found {
  int view;
  const detect::Candidate* candidate;
  Pose scene_from_object;
};

struct ViewPool::Joint {
  Pose scene_from_object;
  Matrix6 information = Matrix6::Zero();  // about the fixed frame's axes, as Refinement's
  int num_correspondences = 0;
};

ViewPool::ViewPool(const Detector& detector, std::span<const ViewSearch* const> views,
                   std::vector<Pose> scene_from_camera, const DetectRequest& request,
                   const ViewsOptions& options)
    : detector_(detector),
      views_(views),
      scene_from_camera_(std::move(scene_from_camera)),
      request_(request),
      options_(options),
      plan_(detector.options().detect, detector.score_layers()) {
  std::uint32_t pixels = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    first_pixel_.push_back(pixels);
    pixels += static_cast<std::uint32_t>(views_[v]->scene.map.size());
    std::vector<PosePrior>& priors = priors_.emplace_back();
    for (const PosePrior& prior : request_.priors) {
      priors.push_back(detect::transformed(scene_from_camera_[v].inverse(), prior));
    }
  }
}

std::vector<ViewPool::Found> ViewPool::all_found() const {
  std::vector<Found> out;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    for (const detect::Candidate& candidate : views_[v]->candidates) {
      if (candidate.score < options_.min_pooled_score) continue;
      out.push_back({static_cast<int>(v), &candidate, scene_from_camera_[v] * candidate.pose()});
    }
  }
  std::ranges::stable_sort(out, std::greater(),
                           [](const Found& found) { return found.candidate->score; });
  return out;
}

bool ViewPool::same(const Entry& entry, const Found& found) const {
  if (entry.model != found.candidate->model || entry.known[found.view]) return false;
  // A fast no: symmetries leave the centre about where it is.
  const double far = tolerance::kCentreMoves * entry.model->diameter + options_.same_position_m;
  const Eigen::Vector3d& centre = entry.model->centre;
  if ((found.scene_from_object * centre - entry.place).norm() > far) return false;
  const Pose pose = joint(entry).scene_from_object;
  const PoseError error = pose_error(found.scene_from_object, pose, entry.model->symmetry);
  return error.position < options_.same_position_m && error.angle < options_.same_angle_rad;
}

void ViewPool::add(const Found& found) {
  Entry* entry = nullptr;
  for (Entry& other : entries_) {
    if (same(other, found)) {
      entry = &other;
      break;
    }
  }
  const bool is_new = entry == nullptr;
  if (is_new) {
    entry = &entries_.emplace_back();
    entry->model = found.candidate->model;
    entry->place = found.scene_from_object * entry->model->centre;
    entry->in_view.assign(views_.size(),
                          detect::Candidate{.model = entry->model, .score = kNotSeen});
    entry->known.assign(views_.size(), false);
  }
  detect::Candidate candidate = *found.candidate;
  if (!is_new && !entry->model->symmetry.trivial()) {
    const Pose pose = nearest_symmetric_pose(
        found.scene_from_object, joint(*entry).scene_from_object, entry->model->symmetry);
    candidate.refinement = search_in(found.view, *entry->model)
                               .measured(scene_from_camera_[found.view].inverse() * pose);
  }
  entry->in_view[found.view] = std::move(candidate);
  entry->known[found.view] = true;
}

void ViewPool::gather() {
  for (const Found& found : all_found()) add(found);
  for_each_model_and_view([this](int view, const ObjectModel& model, SearchEffort& effort) {
    score_in(view, model, effort);
  });
  for (Entry& entry : entries_) entry.known.assign(views_.size(), true);
}

detect::Search ViewPool::search_in(int view, const ObjectModel& model) const {
  return {views_[view]->scene,      model,         plan_,
          detector_.score_layers(), priors_[view], request_.seed};
}

void ViewPool::for_each_model_and_view(
    const std::function<void(int, const ObjectModel&, SearchEffort&)>& work) {
  std::vector<const ObjectModel*> models;
  for (const Entry& entry : entries_) {
    if (std::ranges::count(models, entry.model) == 0) models.push_back(entry.model);
  }
  const std::size_t count = models.size() * views_.size();
  std::vector<SearchEffort> efforts(count);
  parallel_for(count, request_.num_threads, [&](std::size_t k) {
    work(static_cast<int>(k % views_.size()), *models[k / views_.size()], efforts[k]);
  });
  for (const SearchEffort& effort : efforts) effort_ += effort;
}

// A placement that another view found: near that pose it goes where this view shows it, since the
// cameras' poses are not exact.
void ViewPool::score_in(int view, const ObjectModel& model, SearchEffort& effort) {
  const detect::Search search = search_in(view, model);
  detect::RefinementOptions near = detect::kLastAlignment;
  near.start_gate_m = std::min(near.start_gate_m, options_.same_position_m);
  near.end_gate_m = std::min(near.end_gate_m, near.start_gate_m);
  for (Entry& entry : entries_) {
    if (entry.model != &model || entry.known[view]) continue;
    const Pose start = scene_from_camera_[view].inverse() * joint(entry).scene_from_object;
    if (!((start * model.centre).z() > 0)) continue;  // behind the camera
    detect::Refinement refinement = search.refine(start, near);
    const PoseError moved = pose_error(refinement.frame_from_object, start);
    if (moved.position > options_.same_position_m || moved.angle > options_.same_angle_rad ||
        search.quick_score(refinement.frame_from_object) < search.quick_score(start)) {
      refinement = search.measured(start);
    }
    const detect::Candidate candidate{
        .model = &model, .found_by = detect::Source::prior, .is_protected = true};
    entry.in_view[view] = search.scored(candidate, refinement);
  }
  effort += search.effort;
}

void ViewPool::compare() {
  for_each_model_and_view(
      [this](int view, const ObjectModel& model, SearchEffort&) { compare_in(view, model); });
}

void ViewPool::compare_in(int view, const ObjectModel& model) {
  detect::Candidates candidates;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].model != &model || entries_[i].in_view[view].score == kNotSeen) continue;
    candidates.push_back(entries_[i].in_view[view]);
    candidates.back().scene_point = static_cast<int>(i);  // the stage sorts them
  }
  for (detect::Candidate& candidate :
       bpa::detect::compare(search_in(view, model), std::move(candidates))) {
    const int i = candidate.scene_point;
    candidate.scene_point = -1;
    entries_[i].in_view[view] = std::move(candidate);
  }
}

// The mean of what the views say, weighted by information.
ViewPool::Joint ViewPool::joint(const Entry& entry) const {
  int best = -1;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const bool better = best < 0 || entry.in_view[v].score > entry.in_view[best].score;
    if (entry.known[v] && better) best = static_cast<int>(v);
  }
  const Pose reference = scene_from_camera_[best] * entry.in_view[best].pose();
  Joint out{reference};
  Vector6 sum = Vector6::Zero();
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const detect::Candidate& candidate = entry.in_view[v];
    // A view whose evidence says that nothing is there says nothing of where it is.
    const bool says = entry.known[v] && candidate.score >= options_.min_pooled_score;
    if (!says && static_cast<int>(v) != best) continue;
    const Pose pose = scene_from_camera_[v] * candidate.pose();
    const Matrix6 information =
        with_camera_error(turned(scene_from_camera_[v].matrix(), candidate.refinement.information),
                          candidate.place().norm(), options_);
    Vector6 offset;
    offset << pose.translation - reference.translation,
        vector_from_rotation(pose.rotation * reference.rotation.conjugate());
    sum += information * offset;
    out.information += information;
    out.num_correspondences += candidate.refinement.num_correspondences;
  }
  const Vector6 offset = out.information.ldlt().solve(sum);
  if (!offset.allFinite()) return out;
  out.scene_from_object.translation += offset.head<3>();
  out.scene_from_object.rotation =
      (rotation_from_vector(offset.tail<3>()) * reference.rotation).normalized();
  return out;
}

detect::Candidate ViewPool::joined(const Entry& entry) const {
  std::size_t most = 0;
  std::vector<ViewEvidence> evidence;
  const Joint pose = joint(entry);
  detect::Candidate out{
      .model = entry.model,
      .refinement = {pose.scene_from_object, pose.information, pose.num_correspondences}};
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const detect::Candidate& candidate = entry.in_view[v];
    evidence.push_back({candidate.score - candidate.prior, visibility_of(candidate)});
    if (evidence[v].visibility > evidence[most].visibility) most = v;
    for (const std::uint32_t pixel : candidate.explained) {
      out.explained.push_back(first_pixel_[v] + pixel);
    }
  }
  const detect::Candidate& clearest = entry.in_view[most];
  out.found_by = clearest.found_by;
  out.values = clearest.values;
  out.prior = clearest.prior;
  out.score = combined_log_odds(evidence, options_) + out.prior;
  out.probability = score::probability_of(out.score);
  return out;
}

detect::Candidates ViewPool::joined() const {
  detect::Candidates out(entries_.size());
  parallel_for(entries_.size(), request_.num_threads,
               [&](std::size_t i) { out[i] = joined(entries_[i]); });
  return out;
}

scene::Overlaps ViewPool::overlaps(const detect::Candidates& joined) const {
  scene::Overlaps out = scene::find_overlaps(joined, plan_.limits[score::Limit::competing]);
  const auto conflict_in_a_view = [&](const Entry& a, const Entry& b) {
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const auto& first = a.in_view[v].explained;
      const auto& second = b.in_view[v].explained;
      const auto smaller = static_cast<double>(std::min(first.size(), second.size()));
      const auto seen =
          static_cast<double>(std::min(most_explained(a.in_view), most_explained(b.in_view)));
      if (smaller == 0 || smaller < kDecidingShare * seen) continue;
      if (detect::common_pixels(first, second) > detect::kMaxShared * smaller) return true;
    }
    return false;
  };
  parallel_for(out.size(), request_.num_threads, [&](std::size_t i) {
    for (scene::Overlap& overlap : out[i]) {
      if (overlap.conflicting) continue;
      overlap.conflicting = conflict_in_a_view(entries_[i], entries_[overlap.other]);
    }
  });
  return out;
}

void ViewPool::judge(const scene::Present& present, const scene::Overlaps& overlaps) {
  for (std::size_t v = 0; v < views_.size(); ++v) {
    detect::Candidates candidates;
    for (Entry& entry : entries_) candidates.push_back(std::move(entry.in_view[v]));
    scene::measure_given_others(views_[v]->scene, overlaps, present, candidates,
                                plan_.limits[score::Limit::competing], request_.num_threads);
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      detect::Candidate& candidate = candidates[i];
      if (v > 0) candidate.values[score::component("copies")] = score::kNotKnown;  // counts once
      if (candidate.score > kNotSeen) {
        apply_layer(detector_.score_layers().last_for(candidate.values), candidate);
      }
      entries_[i].in_view[v] = std::move(candidate);
    }
  }
}

int ViewPool::observed_pixels() const {
  std::ptrdiff_t count = 0;
  for (const ViewSearch* view : views_) count += std::ranges::count(view->scene.map.searched, 1);
  return static_cast<int>(count);
}

}  // namespace bpa
