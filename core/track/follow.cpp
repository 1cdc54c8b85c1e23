// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/follow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "core/detect/candidate.hpp"
#include "core/detect/refinement.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/model/model_index.hpp"
#include "core/result/placement.hpp"
#include "core/score/rival_poses.hpp"
#include "core/score/surface_agreement.hpp"
#include "core/track/observe.hpp"

namespace bpa::track {
namespace {

// What the surface at a pose must show. Chosen by hand on simulated sequences.
constexpr double kMinVisible = 0.08;     // of the facing surface: less decides nothing
constexpr double kDecides = 0.2;         // of it: so much in sight, and elsewhere, is absent
constexpr double kMinAgreeing = 0.5;     // of the visible surface
constexpr double kMaxFreeSpace = 0.3;    // of it
constexpr double kMaxBackground = 0.8;   // of the agreeing surface
constexpr int kMinCorrespondences = 12;  // of the alignment

// A pose is in doubt where its round-two log odds are that much below the object's usual ones, and
// below those of 99 of 100 right poses with as much in sight (four simulated sequences).
constexpr double kMostVisible = 0.6;  // visible fraction from which most of the object is in sight
constexpr double kBelowUsual = 4;
constexpr std::array<std::pair<double, double>, 4> kLeastLogOdds = {
    {{kMostVisible, -4.6}, {0.35, -7.3}, {0.2, -7.1}, {0, -9.5}}};  // from this visible fraction on
constexpr double kBelowUsualFound = 1.5;  // of an absent object, which a bare table may resemble
constexpr int kMaxDoubts = 5;        // frames in a row; then a hand or another surface is followed
constexpr double kUsualRate = 0.03;  // share of a frame in the running mean of the log odds

// A pose that is known well is aligned in fewer steps than a hypothesis of the search.
constexpr detect::RefinementOptions kAlignment{4, 200, 60, tolerance::placed_m(12),
                                               tolerance::placed_m(4)};
constexpr detect::RefinementOptions kWideAlignment{8, 200, 60, tolerance::placed_m(24),
                                                   tolerance::placed_m(4)};
constexpr double kMargin_m = tolerance::placed_m(12);  // around the object
// Starts about the predicted pose, for an object that a hand has seized: its motion is sudden, and
// the alignment slides on to the hand.
constexpr double kOffset_m = 0.02, kOffset_rad = 0.3;
constexpr int kMaxTried = 15;                            // frames in a row
constexpr double kMaxJump_m = 0.12, kMaxJump_rad = 0.8;  // in one frame

// A resting object is aligned again where its surroundings change, or after 0.3 s.
constexpr int kStep_px = 4;            // between depths that are compared
constexpr double kMaxChanged = 0.005;  // of the depths; noise

// Modes: views that differ by less say the same again. A nat of evidence counts for a twentieth, as
// errors of models and calibration are the same in all views. Where little of the object is
// visible, modes slide behind what hides it.
constexpr double kNewView_rad = 0.05;
constexpr double kTempered = 0.05;
constexpr double kLittleEvidence = 4;  // nats
constexpr double kMostEvidence = 60;   // nats of one comparison
constexpr double kMinCompared = 0.35;  // visible fraction
constexpr double kSwitches = 2;        // log weight at which another mode becomes the pose
constexpr int kComparedAtLeast = 3;    // times, whatever the views
constexpr double kUnlikely = -5;       // log weight of a mode that is dropped
constexpr double kTurnedWeight = -3;   // log weight of a near-symmetric turn that nobody suggests
constexpr double kMaxSlide_rad = 0.1;  // of a mode, while it is aligned
constexpr int kMinFramesBetween = 5;   // comparisons
constexpr std::size_t kMostModes = 40;
// Modes that are compared in a frame, so that none takes long: 0.17 us a pixel and mode. By hand.
constexpr std::size_t kMostCompared = 10, kLeastCompared = 2, kComparedPixels = 50000;

Sight sight_of(const score::SurfaceAgreement& surface, int correspondences) {
  const bool agrees = surface.agreeing >= kMinAgreeing && surface.free_space <= kMaxFreeSpace &&
                      surface.background <= kMaxBackground;
  if (surface.visibility >= kMinVisible && agrees && correspondences >= kMinCorrespondences) {
    return Sight::seen;
  }
  return surface.visibility >= kDecides && !agrees ? Sight::absent : Sight::hidden;
}

// An aligned pose, and what speaks for it.
struct Fit {
  Sight sight = Sight::hidden;
  UncertainPose measured;  // about the axes of the tracks' frame of reference
  double log_odds = 0;     // of the round-two score
  double visible_fraction = 0;
};

Fit judged(const ObservedFrame& observed, const score::FeaturePlaces& places, const Pose& start,
           const detect::RefinementOptions& alignment) {
  const ObjectModel& model = places.model();
  detect::Candidate candidate{.model = &model,
                              .refinement = detect::refine_pose(
                                  observed.scene, model, observed.in_camera(start), alignment)};
  score::Evidence evidence(observed.scene, places, candidate.pose());
  candidate.values = measure(evidence, score::Round::two);
  const Placement placement =
      transformed(observed.frame_from_camera, detect::to_placement(candidate));
  return {sight_of(evidence.surface(), candidate.refinement.num_correspondences),
          {placement.frame_from_object, placement.covariance},
          observed.layers.round_two.log_odds(candidate.values),
          evidence.surface().visibility};
}

// Aligns the object with the frame from one of several starts in the tracks' frame of reference:
// the best by round-two score.
Fit fit(const ObservedFrame& observed, const score::FeaturePlaces& places,
        const std::vector<Pose>& starts, const detect::RefinementOptions& alignment) {
  Fit best;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    Fit now = judged(observed, places, starts[i], alignment);
    const bool better = std::pair(now.sight == Sight::seen, now.log_odds) >
                        std::pair(best.sight == Sight::seen, best.log_odds);
    if (i == 0 || better) best = now;
  }
  return best;
}

bool in_doubt(const Body& body, const Fit& fit) {
  const auto least = std::ranges::find_if(
      kLeastLogOdds, [&](const auto& entry) { return fit.visible_fraction >= entry.first; });
  return fit.log_odds < std::min(body.usual_log_odds.value_or(0) - kBelowUsual, least->second);
}

// A pose that is in doubt for too long is of another surface. So is one of an absent object, unless
// it looks as usual.
void doubt(Body& body, Fit& fit) {
  if (fit.sight != Sight::seen) return;
  if (body.sight == Sight::absent &&
      fit.log_odds < body.usual_log_odds.value_or(0) - kBelowUsualFound) {
    fit.sight = Sight::absent;
    return;
  }
  if (in_doubt(body, fit)) {
    if (++body.doubts >= kMaxDoubts) fit.sight = Sight::absent;
    return;
  }
  body.doubts = 0;
  if (fit.visible_fraction < kMostVisible) return;
  const double usual = body.usual_log_odds.value_or(fit.log_odds);
  body.usual_log_odds = usual + kUsualRate * (fit.log_odds - usual);
}

std::vector<Pose> starts_about(const Pose& pose) {
  std::vector<Pose> out;
  for (int axis = 0; axis < 6; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Vector6d by = Vector6d::Zero();
      by[axis] = sign * (axis < 3 ? kOffset_m : kOffset_rad);
      out.push_back(moved(pose, by));
    }
  }
  return out;
}

bool same_pose(const Body& body, const Pose& a, const Pose& b) {
  return within_tolerance(a, b, body.model->symmetry);
}

// Adds another pose unless the body has it. Returns whether it did.
bool propose(Body& body, const Pose& object_from_mode, double log_weight) {
  const auto same = [&](const Pose& other) { return same_pose(body, object_from_mode, other); };
  if (same(Pose()) || body.modes.size() >= kMostModes) return false;
  const auto known = std::ranges::find_if(
      body.modes, [&](const Mode& mode) { return same(mode.object_from_mode); });
  if (known == body.modes.end()) {
    body.modes.push_back({object_from_mode, log_weight});
    return true;
  }
  known->log_weight = std::max(known->log_weight, log_weight);
  return false;
}

// Whether the camera looks at the object from elsewhere than when its modes were last compared.
bool is_new_view(const Body& body, const Pose& object_from_camera) {
  if (body.frames_since_compared < kMinFramesBetween) return false;
  const Eigen::Vector3d now = object_from_camera.translation - body.model->centre;
  const Eigen::Vector3d before = body.compared_from.translation - body.model->centre;
  return std::atan2(now.cross(before).norm(), now.dot(before)) >= kNewView_rad;
}

// The likeliest mode becomes the pose, and the pose a mode.
void make_pose(std::size_t k, Body& body) {
  const Mode winner = body.modes[k];
  const Pose back = winner.object_from_mode.inverse();
  for (Mode& mode : body.modes) {
    mode = {back * mode.object_from_mode, mode.log_weight - winner.log_weight};
  }
  body.modes[k] = {back, -winner.log_weight};
  body.motion.jump_to(body.motion.pose() * winner.object_from_mode);
  body.last_seen = body.motion.pose();
  body.compared_from = back * body.compared_from;
}

// The likeliest mode becomes the pose if it is clearly likelier; unlikely ones are dropped.
void settle(Body& body) {
  const auto best = std::ranges::max_element(body.modes, {}, &Mode::log_weight);
  if (best != body.modes.end() && best->log_weight > kSwitches) {
    make_pose(best - body.modes.begin(), body);
  }
  std::erase_if(body.modes, [](const Mode& mode) { return mode.log_weight < kUnlikely; });
}

// The first modes; `own` is the pose, aligned.
void weigh_modes(const SceneFeatures& scene, const Pose& own, const Pose& camera_from_object,
                 const ObjectModel& model, std::span<Mode> modes) {
  std::vector<Pose> poses = {own};
  for (const Mode& mode : modes) poses.push_back(camera_from_object * mode.object_from_mode);
  const auto behind = score::behind_best(scene, model, poses, poses.size());
  // Of a mode against the pose. A little says nothing, as the errors of a model favour one of them.
  const auto evidence = [&](std::size_t k) {
    const double nats = behind[k].depth + behind[k].color - behind[0].depth - behind[0].color;
    const double beyond = std::max(0.0, std::abs(nats) - kLittleEvidence);
    return std::copysign(std::min(kMostEvidence, beyond), nats);
  };
  for (std::size_t k = 0; k < modes.size(); ++k) {
    modes[k].log_weight += kTempered * evidence(k + 1);
  }
}

std::optional<RegionOfInterest> surroundings_of(const Frame& frame, const Pose& frame_from_camera,
                                                const Body& body) {
  return surroundings(frame, *body.model, frame_from_camera.inverse() * body.motion.pose(),
                      kMargin_m);
}

// Looks where the object is predicted, and further away where it is not there.
Fit found_at(const ObservedFrame& observed, const Pose& predicted, const Body& body) {
  Fit found = fit(observed, *body.places, {predicted}, kAlignment);
  if (found.sight == Sight::seen && body.unseen == 0 && !in_doubt(body, found)) return found;
  const Fit wide = fit(observed, *body.places, {predicted, body.last_seen}, kWideAlignment);
  if (wide.sight == Sight::seen && (found.sight != Sight::seen || wide.log_odds > found.log_odds))
    found = wide;
  const bool misled =
      found.sight == Sight::absent || (found.sight == Sight::seen && in_doubt(body, found));
  if (misled && std::max(body.doubts, body.unseen) < kMaxTried) {
    const Fit other = fit(observed, *body.places, starts_about(predicted), kWideAlignment);
    if (other.sight == Sight::seen && !in_doubt(body, other)) return other;
  }
  return found;
}

}  // namespace

void predict(double seconds, Body& body) { body.motion.predict(seconds, body.unseen == 0); }

bool looks_unchanged(const Frame& frame, const SensorNoise& noise, const Pose& frame_from_camera,
                     const Body& body) {
  if (body.motion.moves() || body.sight != Sight::seen) return false;
  const auto around = surroundings_of(frame, frame_from_camera, body);
  return around && *around == body.around_region &&
         changed_share(sampled_depths(frame, *around, kStep_px), body.around, noise) <= kMaxChanged;
}

void correct(const ObservedFrame& observed, Body& body) {
  MotionFilter& motion = body.motion;
  const Pose predicted = motion.pose();
  const auto around = surroundings_of(observed.frame, observed.frame_from_camera, body);
  Fit found = around ? found_at(observed, predicted, body) : Fit();
  if (found.sight == Sight::seen) {
    const Vector6d jump = difference(found.measured.pose, predicted);
    const bool near = jump.head<3>().norm() < kMaxJump_m && jump.tail<3>().norm() < kMaxJump_rad;
    if (!near) found.sight = Sight::absent;
  }
  doubt(body, found);
  body.sight = found.sight;
  body.visible_fraction = found.visible_fraction;
  if (found.sight != Sight::seen) {
    ++body.unseen;
    body.seen = 0;
    return;
  }
  body.before = motion;
  motion.update(found.measured);
  body.unseen = 0;
  ++body.seen;
  body.last_seen = motion.pose();
  body.around_region = *around;
  body.around = sampled_depths(observed.frame, *around, kStep_px);
}

void take_back(Body& body) {
  if (body.before) body.motion = *body.before;
  body.sight = Sight::hidden;
  ++body.unseen;
  body.seen = 0;
}

void add_mode(Body& body, const Pose& frame_from_object, double log_weight) {
  const Pose relative = body.motion.pose().inverse() * frame_from_object;
  if (propose(body, relative, log_weight)) body.compared = 0;
}

void compare_modes(const ObservedFrame& observed, Body& body) {
  ++body.frames_since_compared;
  if (body.sight != Sight::seen || body.visible_fraction < kMinCompared) return;
  const ObjectModel& model = *body.model;
  if (body.modes.empty() && model.index->near_symmetries.empty()) return;
  const Pose camera_from_object = observed.in_camera(body.motion.pose());
  const Pose from = camera_from_object.inverse();
  const bool goes_on = body.to_compare > 0;
  if (!goes_on && body.compared >= kComparedAtLeast && !is_new_view(body, from)) return;
  const auto around = surroundings_of(observed.frame, observed.frame_from_camera, body);
  if (!around) return;
  const SceneFeatures scene = observe_part_colors(observed.frame, *around,
                                                  observed.scene.map.sensor, observed.scene.planes);
  // All are aligned alike, or those that are would seem likelier. A turn that the view leaves open
  // slides to where another mode is; then it stays as it was.
  const auto aligned = [&](const Pose& start) {
    const Pose pose = detect::aligned_pose(scene, model, start, kAlignment);
    return pose_error(pose, start).angle < kMaxSlide_rad ? pose : start;
  };
  const Pose own = aligned(camera_from_object), object_from_own = from * own;
  if (!goes_on) {
    body.compared_from = from;
    body.frames_since_compared = 0;
    ++body.compared;
    for (const Pose& motion : model.index->near_symmetries) {
      propose(body, object_from_own * motion, kTurnedWeight);
    }
    body.to_compare = body.modes.size();
  }
  const std::size_t at_once =
      std::clamp(kComparedPixels / scene.image.pixels.size(), kLeastCompared, kMostCompared);
  const std::size_t count = std::min({body.to_compare, body.modes.size(), at_once});
  const std::span<Mode> modes = std::span(body.modes).first(count);
  for (Mode& mode : modes) {
    mode.object_from_mode = from * aligned(camera_from_object * mode.object_from_mode);
  }
  weigh_modes(scene, own, camera_from_object, model, modes);
  body.to_compare = std::min(body.to_compare, body.modes.size()) - count;
  std::ranges::rotate(body.modes, body.modes.begin() + static_cast<std::ptrdiff_t>(count));
  settle(body);
}

void favour_mode(Body& body, const Pose& frame_from_object, double log_weight, double says) {
  const Pose relative = body.motion.pose().inverse() * frame_from_object;
  const bool own = same_pose(body, relative, Pose());
  if (!own) add_mode(body, frame_from_object, log_weight);
  for (Mode& mode : body.modes) {
    if (own) mode.log_weight -= says;
    if (!own && same_pose(body, relative, mode.object_from_mode)) mode.log_weight += says;
  }
  settle(body);
}

}  // namespace bpa::track
