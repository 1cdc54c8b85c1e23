// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>

#include "core/eval/evaluation.hpp"

namespace bpa::eval {
namespace {

using Estimates = std::vector<Placement>;
using Instances = std::vector<io::BopInstance>;
using Costs = std::vector<std::vector<double>>;
using Cost = std::function<double(const Placement&, const io::BopInstance&)>;

constexpr double kAddDiameters = 0.1;
constexpr double kMspdPixelsPerThreshold = 100;  // 0.05 -> 5 pixels, at 640 pixels of width

Costs pair_costs(const Estimates& estimates, const Instances& truth, const Cost& cost) {
  Costs costs(estimates.size(), std::vector<double>(truth.size(), kNoMatch));
  for (std::size_t e = 0; e < estimates.size(); ++e) {
    for (std::size_t t = 0; t < truth.size(); ++t) {
      if (estimates[e].model_number == truth[t].obj_id) costs[e][t] = cost(estimates[e], truth[t]);
    }
  }
  return costs;
}

std::vector<double> scores_of(const Estimates& estimates) {
  std::vector<double> scores;
  for (const Placement& estimate : estimates) scores.push_back(estimate.probability);
  return scores;
}

/// The paper's criterion: both errors relative to their limits, the larger one.
double paper_cost(const EvalObjects& objects, const EvaluationOptions& options,
                  const Pose& estimate, const io::BopInstance& truth) {
  return right_cost(estimate, truth.camera_from_object, objects.at(truth.obj_id).symmetry,
                    options.position_m, options.angle_rad);
}

/// Only what counts takes part in BOP's errors, and for each object at most as many estimates, the
/// most probable ones, as there are instances.
struct BopCase {
  Estimates estimates;
  Instances truth;
};

BopCase bop_case(const Estimates& estimates, const Instances& truth, double min_visible) {
  BopCase result;
  std::map<int, int> room;
  for (const io::BopInstance& instance : truth) {
    if (instance.visible_fraction < min_visible) continue;
    result.truth.push_back(instance);
    ++room[instance.obj_id];
  }
  Estimates sorted = estimates;
  std::ranges::stable_sort(sorted, std::greater(), &Placement::probability);
  for (const Placement& estimate : sorted) {
    if (room[estimate.model_number]-- > 0) result.estimates.push_back(estimate);
  }
  return result;
}

int matched(const std::vector<double>& scores, const Costs& costs, double threshold) {
  const std::vector<int> truth_of = match_greedily(scores, costs, threshold);
  return static_cast<int>(std::ranges::count_if(truth_of, [](int t) { return t >= 0; }));
}

/// VSD of every pair of the same object, for each tolerance.
std::array<Costs, 10> vsd_costs(const BopCase& bop, const EvalObjects& objects,
                                const Frame& measured) {
  std::array<Costs, 10> costs;
  costs.fill(Costs(bop.estimates.size(), std::vector<double>(bop.truth.size(), kNoMatch)));
  const auto render = [&](int obj_id, const Pose& pose) {
    return render_depth(objects.at(obj_id).mesh, pose, measured.camera);
  };
  for (std::size_t e = 0; e < bop.estimates.size(); ++e) {
    const Placement& estimate = bop.estimates[e];
    const auto at_estimate = render(estimate.model_number, estimate.frame_from_object);
    for (std::size_t t = 0; t < bop.truth.size(); ++t) {
      const io::BopInstance& truth = bop.truth[t];
      if (estimate.model_number != truth.obj_id) continue;
      const std::array<double, 10> errors = visible_surface_discrepancy(
          at_estimate, render(truth.obj_id, truth.camera_from_object), measured.depth,
          measured.camera, objects.at(truth.obj_id).diameter);
      for (std::size_t k = 0; k < errors.size(); ++k) costs[k][e][t] = errors[k];
    }
  }
  return costs;
}

Status add_bop_errors(const io::BopFrame& frame, const EvalObjects& objects,
                      const Estimates& estimates, const EvaluationOptions& options,
                      FrameOutcome& outcome) {
  const BopCase bop = bop_case(estimates, frame.truth, options.min_visible_fraction);
  if (bop.estimates.empty() || bop.truth.empty()) return {};
  const Result<Frame> measured = io::load_bop_frame(frame);
  if (!measured.ok()) return measured.status();
  std::map<int, std::vector<Pose>> symmetries;
  for (const io::BopInstance& truth : bop.truth) {
    symmetries.try_emplace(truth.obj_id, discretised_symmetries(objects.at(truth.obj_id).symmetry));
  }
  const std::vector<double> scores = scores_of(bop.estimates);
  const Costs mssd = pair_costs(bop.estimates, bop.truth, [&](const auto& e, const auto& t) {
    const EvalObject& object = objects.at(t.obj_id);
    return max_surface_distance(object.mesh.vertices, e.frame_from_object, t.camera_from_object,
                                symmetries.at(t.obj_id)) /
           object.diameter;
  });
  const Costs mspd = pair_costs(bop.estimates, bop.truth, [&](const auto& e, const auto& t) {
    return max_projection_distance(objects.at(t.obj_id).mesh.vertices, e.frame_from_object,
                                   t.camera_from_object, symmetries.at(t.obj_id),
                                   measured->camera) *
           640 / measured->camera.width / kMspdPixelsPerThreshold;
  });
  const Costs add = pair_costs(bop.estimates, bop.truth, [&](const auto& e, const auto& t) {
    const EvalObject& object = objects.at(t.obj_id);
    const auto error = object.symmetry.trivial() ? average_distance : average_nearest_distance;
    return error(object.mesh.vertices, e.frame_from_object, t.camera_from_object) / object.diameter;
  });
  const std::array<Costs, 10> vsd = vsd_costs(bop, objects, *measured);
  outcome.add_correct = matched(scores, add, kAddDiameters);
  for (std::size_t k = 0; k < kBopThresholds.size(); ++k) {
    outcome.mssd[k] = matched(scores, mssd, kBopThresholds[k]);
    outcome.mspd[k] = matched(scores, mspd, kBopThresholds[k]);
    for (std::size_t tolerance = 0; tolerance < vsd.size(); ++tolerance) {
      outcome.vsd[tolerance][k] = matched(scores, vsd[tolerance], kBopThresholds[k]);
    }
  }
  return {};
}

/// The RMSE criterion over the best interpretation.
void add_rmse(const io::BopFrame& frame, const EvalObjects& objects, const Estimates& estimates,
              const EvaluationOptions& options, FrameOutcome& outcome) {
  const Costs costs = pair_costs(estimates, frame.truth, [&](const auto& e, const auto& t) {
    const EvalObject& object = objects.at(t.obj_id);
    // The symmetric truth nearest in orientation: one of the whole group need not be tried.
    const Pose nearest =
        nearest_symmetric_pose(t.camera_from_object, e.frame_from_object, object.symmetry);
    return rms_distance(object.mesh.vertices, e.frame_from_object, nearest, {Pose{}});
  });
  for (const int t : match_greedily(scores_of(estimates), costs, options.rmse_m)) {
    if (t >= 0 && !outcome.truth[t].counts) continue;
    ++outcome.rmse_reported;
    if (t < 0) continue;
    ++outcome.rmse_correct;
    outcome.truth[t].found_rmse = true;
  }
}

// The nearest instance of the same object, at most 5 cm away, or null.
const io::BopInstance* instance_at(const io::BopFrame& frame, const Placement& estimate) {
  constexpr double kSamePlace = 2 * kPoseTolerance_m;
  const io::BopInstance* nearest = nullptr;
  double least = kSamePlace;
  for (const io::BopInstance& truth : frame.truth) {
    const double distance =
        (truth.camera_from_object.translation - estimate.frame_from_object.translation).norm();
    if (truth.obj_id != estimate.model_number || distance > least) continue;
    least = distance;
    nearest = &truth;
  }
  return nearest;
}

std::vector<PoseOutcome> open_poses(const io::BopInstance* instance, const EvalObjects& objects,
                                    const EvaluationOptions& options, const Placement& estimate) {
  if (estimate.alternatives.empty() || !instance) return {};
  const auto is_right = [&](const Pose& pose) {
    return paper_cost(objects, options, pose, *instance) < kNoMatch;
  };
  std::vector<PoseOutcome> out{{own_weight(estimate), is_right(estimate.frame_from_object)}};
  for (const PoseAlternative& other : estimate.alternatives) {
    out.push_back({other.weight, is_right(other.frame_from_object)});
  }
  return out;
}

/// Instances whose pose is that of an estimate or of one of its alternatives.
std::vector<bool> among_alternatives(const io::BopFrame& frame, const Estimates& estimates,
                                     const EvalObjects& objects, const EvaluationOptions& options) {
  std::vector<bool> found;
  for (const io::BopInstance& truth : frame.truth) {
    const auto is_right = [&](const Pose& pose) {
      return paper_cost(objects, options, pose, truth) < kNoMatch;
    };
    found.push_back(std::ranges::any_of(estimates, [&](const Placement& estimate) {
      return estimate.model_number == truth.obj_id &&
             (is_right(estimate.frame_from_object) ||
              std::ranges::any_of(estimate.alternatives, is_right,
                                  &PoseAlternative::frame_from_object));
    }));
  }
  return found;
}

void add_estimates(const io::BopFrame& frame, const EvalObjects& objects,
                   const Estimates& estimates, const std::vector<int>& truth_of,
                   const EvaluationOptions& options, FrameOutcome& outcome) {
  for (std::size_t e = 0; e < estimates.size(); ++e) {
    const Placement& estimate = estimates[e];
    const Pose& pose = estimate.frame_from_object;
    EstimateOutcome& result = outcome.estimates.emplace_back();
    result.obj_id = estimate.model_number;
    result.probability = estimate.probability;
    result.distance = pose.translation.norm();
    result.truth = truth_of[e];
    const io::BopInstance* instance = instance_at(frame, estimate);
    result.present = instance != nullptr;
    result.poses = open_poses(instance, objects, options, estimate);
    if (result.truth < 0) continue;
    const EvalObject& object = objects.at(estimate.model_number);
    const Pose& truth = frame.truth[result.truth].camera_from_object;
    const Pose nearest = nearest_symmetric_pose(truth, pose, object.symmetry);
    TruthOutcome& found = outcome.truth[result.truth];
    found.found = true;
    found.add = average_distance(object.mesh.vertices, pose, nearest);
    found.adds = average_nearest_distance(object.mesh.vertices, pose, truth);
    result.ignored = !found.counts;
    result.covariance_error =
        covariance_error(estimate.frame_from_object, estimate.covariance, nearest, object.symmetry);
  }
}

}  // namespace

Result<FrameOutcome> evaluate_frame(const io::BopFrame& frame, const EvalObjects& objects,
                                    const io::FrameResult* result,
                                    const EvaluationOptions& options) {
  FrameOutcome outcome;
  outcome.scene_id = frame.scene_id;
  outcome.im_id = frame.im_id;
  outcome.reported = result != nullptr;
  for (const io::BopInstance& truth : frame.truth) {
    outcome.truth.push_back({.obj_id = truth.obj_id,
                             .visible_fraction = truth.visible_fraction,
                             .distance = truth.camera_from_object.translation.norm(),
                             .counts = truth.visible_fraction >= options.min_visible_fraction});
  }
  if (result == nullptr) return outcome;
  outcome.seconds = result->seconds;
  const Cost cost = [&](const auto& e, const auto& t) {
    return paper_cost(objects, options, e.frame_from_object, t);
  };
  for (std::size_t rank = 0; rank < result->interpretations.size(); ++rank) {
    const Estimates& estimates = result->interpretations[rank].placements;
    const std::vector<int> truth_of =
        match_greedily(scores_of(estimates), pair_costs(estimates, frame.truth, cost));
    for (const int t : truth_of) {
      if (t < 0 || outcome.truth[t].found_at_rank > 0) continue;
      outcome.truth[t].found_at_rank = static_cast<int>(rank) + 1;
    }
    const std::vector<bool> open = among_alternatives(frame, estimates, objects, options);
    for (std::size_t t = 0; t < open.size(); ++t) {
      int& found_at = outcome.truth[t].among_alternatives_at_rank;
      if (open[t] && found_at == 0) found_at = static_cast<int>(rank) + 1;
    }
    if (rank > 0) continue;
    add_estimates(frame, objects, estimates, truth_of, options, outcome);
    add_rmse(frame, objects, estimates, options, outcome);
    if (!options.bop_errors) continue;
    if (Status s = add_bop_errors(frame, objects, estimates, options, outcome); !s.ok()) return s;
  }
  return outcome;
}

}  // namespace bpa::eval
