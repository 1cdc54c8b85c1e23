// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/sim/arms.hpp"
#include "core/sim/private/sequence_draft.hpp"

namespace bpa::sim {
namespace {

constexpr int kDraws = 200;        // of an event, until one finds room
constexpr double kGap = 0.012;     // between bodies, metres
constexpr double kApproach = 0.9;  // seconds that an arm takes to come or go
const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

Eigen::Vector3d flat(const Eigen::Vector2d& v) { return {v.x(), v.y(), 0}; }

Eigen::Vector2d draw_direction(RandomStream& random) {
  const double angle = random.uniform(-std::numbers::pi, std::numbers::pi);
  return {std::cos(angle), std::sin(angle)};
}

Place between(const Place& a, const Place& b, double share) {
  return {a.at + share * (b.at - a.at), a.yaw + share * (b.yaw - a.yaw)};
}

/// 0 while the motion lasts, up to 1 before and after it, where the arm is out of sight.
double away(double seconds, double start, double end) {
  return std::clamp(std::max(start - seconds, seconds - end) / kApproach, 0.0, 1.0);
}

void add_move(SequenceDraft& draft, int body, double start, double seconds, PosePath path,
              const Place& to) {
  draft.moves[body].push_back({start, seconds, std::move(path)});
  draft.places[body] = to;
}

/// A fist that follows a body from behind: `path` is the body's place over [0, 1].
void add_fist(SequenceDraft& draft, int body, double start, double seconds,
              const Eigen::Vector2d& direction, const std::function<Place(double)>& path) {
  const TableBody& pushed = draft.bodies[body];
  const double height = std::clamp(0.5 * pushed.top, 0.042, 0.08);
  Eigen::Matrix3d axes;
  axes << flat(direction).cross(kUp), -flat(direction), -kUp;
  const double end = start + seconds;
  const auto pose = [=](double t) {
    const Place place = path(std::clamp((t - start) / seconds, 0.0, 1.0));
    const double behind = reach(pushed, place, -direction) + kFistRadius;
    const double gone = smooth_start_and_stop(away(t, start, end));
    const Eigen::Vector3d contact = flat(place.at - behind * direction) + height * kUp;
    return Pose::from_matrix(axes, contact + gone * (0.6 * kUp - 0.6 * flat(direction)));
  };
  draft.visits.push_back({kFist, start - kApproach, end + kApproach, pose});
}

/// A hand that holds a body while it moves. It comes from above, so that its fingers pass the body.
void add_hand(SequenceDraft& draft, int body, const Grip& grip, double start, double seconds) {
  const Pose from_rest = draft.world_from_rest_at(body, start);
  const Eigen::Vector3d camera = draft.orbit.world_from_camera(start).translation;
  const Eigen::Vector3d view = from_rest.translation - camera;
  // The forearm goes away from the camera.
  const auto lean = [&](const Pose& rest_from_arm) {
    return view.dot((from_rest * rest_from_arm).rotation * Eigen::Vector3d::UnitY());
  };
  const Pose held =
      lean(grip.rest_from_arm) > lean(grip.turned()) ? grip.rest_from_arm : grip.turned();
  const Move move = draft.moves[body].back();
  const double end = start + seconds;
  const auto pose = [=](double t) {
    Pose arm = move.world_from_rest(std::clamp((t - start) / seconds, 0.0, 1.0)) * held;
    const double gone = away(t, start, end);
    const Eigen::Vector3d back = arm.rotation * Eigen::Vector3d::UnitY();
    arm.translation += 0.4 * smooth_start_and_stop(2 * gone) * kUp +
                       0.7 * smooth_start_and_stop(2 * gone - 1) * back;
    return arm;
  };
  draft.visits.push_back({grip.arm, start - kApproach, end + kApproach, pose});
}

/// An instance that is no twin; nothing where there is none.
std::optional<int> draw_single(SequenceDraft& draft) {
  const int body = draft.random.index(draft.num_instances);
  return draft.is_twin(body) ? std::nullopt : std::optional(body);
}

/// Whether a body can slide from one place straight to another, and the fist behind it.
bool can_slide(const SequenceDraft& draft, int body, const Place& from, const Place& to) {
  constexpr int kSteps = 12;
  const Eigen::Vector2d direction = (to.at - from.at).normalized();
  const double radius = draft.bodies[body].radius;
  const double behind = radius + kFistRadius;
  if (!draft.is_free({from.at - behind * direction, kFistRadius}, body)) return false;
  for (int i = 1; i <= kSteps; ++i) {
    const Place at = between(from, to, static_cast<double>(i) / kSteps);
    if (!draft.is_free({at.at, std::max(radius, kFistRadius) + kGap}, body)) return false;
  }
  return true;
}

/// How high a body must be lifted, to be carried straight from one place to another, metres.
double height_over(const SequenceDraft& draft, int body, const Eigen::Vector2d& from,
                   const Eigen::Vector2d& to) {
  constexpr double kLeast = 0.1, kOver = 0.04;
  const Eigen::Vector2d way = to - from;
  double height = kLeast;
  for (int i = 0; i < static_cast<int>(draft.bodies.size()); ++i) {
    const Eigen::Vector2d other = draft.places[i].at - from;
    const double share = std::clamp(other.dot(way) / way.squaredNorm(), 0.0, 1.0);
    const double apart = (other - share * way).norm();
    const double reaches = draft.bodies[i].radius + draft.bodies[body].sphere;
    if (i != body && apart < reaches) height = std::max(height, draft.bodies[i].top + kOver);
  }
  return height;
}

}  // namespace

std::optional<double> add_push(SequenceDraft& draft, double start) {
  for (int i = 0; i < kDraws; ++i) {
    const std::optional<int> body = draw_single(draft);
    const double length = draft.random.uniform(0.08, 0.25);
    const Eigen::Vector2d direction = draw_direction(draft.random);
    const double turn = draft.random.uniform(-1, 1);
    if (!body) continue;
    const Place from = draft.places[*body];
    const Place to{from.at + length * direction, from.yaw + turn};
    if (to.at.norm() > draft.disc + 0.03 || !can_slide(draft, *body, from, to)) continue;
    const auto place = [=](double u) { return between(from, to, smooth_start_and_stop(u)); };
    const PosePath path = [=](double u) { return world_from_rest(place(u)); };
    const double seconds =
        seconds_of([&](double u) { return path(u) * draft.bodies[*body].rest_from_object; },
                   draft.object_limits());
    add_move(draft, *body, start, seconds, path, to);
    add_fist(draft, *body, start, seconds, direction, place);
    draft.events.push_back({SequenceKind::pushed, *body, start, start + seconds});
    return start + seconds;
  }
  return std::nullopt;
}

std::optional<double> add_pick(SequenceDraft& draft, double start) {
  for (int i = 0; i < kDraws; ++i) {
    const std::optional<int> body = draw_single(draft);
    const Eigen::Vector2d direction = draw_direction(draft.random);
    const double away_from_middle = draft.disc * std::sqrt(draft.random.uniform());
    const double turn = draft.random.uniform(-1.5, 1.5), tilt = draft.random.uniform(0, 0.35);
    if (!body) continue;
    const TableBody& picked = draft.bodies[*body];
    const std::optional<Grip> grip = grip_of(picked);
    const Place from = draft.places[*body];
    const Place to{away_from_middle * direction, from.yaw + turn};
    if (!grip || (to.at - from.at).norm() < 0.1) continue;
    if (!draft.is_free({to.at, picked.radius + kGap}, *body)) continue;
    const double height = height_over(draft, *body, from.at, to.at);
    const Eigen::Vector3d axis = tilt * flat(draw_direction(draft.random));
    const double top = picked.top;
    // Straight up, over, and straight down: each takes time as it is long.
    const double lift = height / (2 * height + (to.at - from.at).norm());
    const PosePath path = [=](double u) {
      const double carried = (u - lift) / (1 - 2 * lift);
      const double up = smooth_start_and_stop(u / lift) - smooth_start_and_stop((u - 1) / lift + 1);
      Place place = between(from, to, smooth_start_and_stop(carried));
      place.yaw = between(from, to, smooth_start_and_stop(u)).yaw;
      const Pose upright = world_from_rest(place, height * up);
      const Eigen::Quaterniond tilted = rotation_from_vector(smooth_bump(carried) * axis);
      // Tilted about the hand, above the others' tops: what hangs down swings by top * tilt.
      const Eigen::Vector3d hand(0, 0, top);
      return upright * Pose{tilted, hand - tilted * hand};
    };
    const double seconds = seconds_of([&](double u) { return path(u) * picked.rest_from_object; },
                                      draft.object_limits());
    add_move(draft, *body, start, seconds, path, to);
    add_hand(draft, *body, *grip, start, seconds);
    draft.events.push_back({SequenceKind::picked, *body, start, start + seconds});
    return start + seconds;
  }
  return std::nullopt;
}

std::optional<double> add_occlusion(SequenceDraft& draft, double start) {
  // The smaller of some, so that the arm hides it.
  int body = draft.random.index(draft.num_instances);
  for (int i = 0; i < 3; ++i) {
    const int other = draft.random.index(draft.num_instances);
    if (draft.bodies[body].sphere < 0.07) break;
    if (draft.bodies[other].sphere < draft.bodies[body].sphere) body = other;
  }
  RandomStream& random = draft.random;
  const double dwell = random.uniform(0.1, 0.6) * draft.options.max_occlusion;
  const double angle = random.uniform(-0.5, 0.5) + (random.uniform() < 0.5 ? 0 : std::numbers::pi);
  const double back = random.uniform() < 0.5 ? -1 : 1;  // whether it goes back or on
  const Eigen::Vector3d middle =
      draft.world_from_rest_at(body, start) * draft.bodies[body].middle();
  // Half way to the object, or nearer where the arm would touch what stands high.
  double share = 0.6;
  double highest = 0;
  for (const TableBody& other : draft.bodies) highest = std::max(highest, other.top);
  const Eigen::Vector3d eye = draft.orbit.world_from_camera(start).translation;
  while (share > 0.35 && (eye + share * (middle - eye)).z() < highest + 0.07) share -= 0.05;
  const double end = start + dwell;
  const auto pose = [=, orbit = draft.orbit](double t) {
    constexpr double kPassage = 0.5;  // metres to the side, out of sight of the object
    const Pose camera = orbit.world_from_camera(std::max(t, 0.0));
    const Eigen::Matrix3d axes = camera.matrix();
    const Eigen::Vector3d along = std::cos(angle) * axes.col(0) + std::sin(angle) * axes.col(1);
    const Eigen::Vector3d view = (middle - camera.translation).normalized();
    Eigen::Matrix3d arm;
    arm.col(2) = view;
    arm.col(0) = (along - along.dot(view) * view).normalized();
    arm.col(1) = arm.col(2).cross(arm.col(0));
    const double aside = (t < start ? -1 : back) * smooth_start_and_stop(away(t, start, end));
    const Eigen::Vector3d line = camera.translation + share * (middle - camera.translation);
    return Pose::from_matrix(arm, line + kPassage * aside * arm.col(1));
  };
  draft.visits.push_back({kStraightArm, start - kApproach, end + kApproach, pose});
  draft.events.push_back({SequenceKind::occluded, body, start - kApproach, end + kApproach});
  return end + kApproach;
}

std::optional<double> add_passing(SequenceDraft& draft, double start) {
  if (!draft.twin) return std::nullopt;
  const int first = *draft.twin, second = first + 1;
  const Place a = draft.places[first], b = draft.places[second];
  const Eigen::Vector2d direction = (b.at - a.at).normalized();
  const Eigen::Vector2d side(-direction.y(), direction.x());
  const double aside = draft.bodies[first].radius + 0.5 * kGap;
  const auto place_of = [=](const Place& from, const Place& to, double sign) {
    return [=](double u) {
      Place place = between(from, {to.at, from.yaw}, smooth_start_and_stop(u));
      place.at += sign * aside * smooth_bump(u) * side;
      return place;
    };
  };
  const auto place_a = place_of(a, b, 1), place_b = place_of(b, a, -1);
  const SpeedLimits limits = draft.object_limits();
  double seconds = 0;
  for (const auto& place : {place_a, place_b}) {
    const PosePath path = [&](double u) {
      return world_from_rest(place(u)) * draft.bodies[first].rest_from_object;
    };
    seconds = std::max(seconds, seconds_of(path, limits));
  }
  const auto move = [&](int body, const auto& place, const Eigen::Vector2d& along) {
    add_move(
        draft, body, start, seconds, [place](double u) { return world_from_rest(place(u)); },
        place(1));
    add_fist(draft, body, start, seconds, along, place);
  };
  move(first, place_a, direction);
  move(second, place_b, -direction);
  draft.events.push_back({SequenceKind::twins, first, start, start + seconds});
  return start + seconds;
}

std::optional<double> add_turn(SequenceDraft& draft, double start) {
  constexpr int kBody = 0, kTurns = 12;        // turns to choose from, to each side
  constexpr double kLeast = 1.2, kMost = 3.1;  // radians
  const TableBody& body = draft.bodies[kBody];
  const std::optional<Grip> grip = grip_of(body);
  const Place from = draft.places[kBody];
  const SpeedLimits limits = draft.object_limits();
  const auto path_to = [from](double turn) -> PosePath {
    constexpr double kLift = 0.015;  // metres
    const Place to{from.at, from.yaw + turn};
    return [=](double u) {
      return world_from_rest(between(from, to, smooth_start_and_stop(u)), kLift * smooth_bump(u));
    };
  };
  const auto seconds_to = [&](double turn) {
    const PosePath path = path_to(turn);
    return seconds_of([&](double u) { return path(u) * body.rest_from_object; }, limits);
  };
  // The one after which the telltales are seen best, once the hand is gone: from the front and
  // side.
  constexpr double kBestFacing = 0.5;  // cosine to the camera
  double best_turn = kMost, nearest = 2;
  for (int i = 0; i < 2 * kTurns; ++i) {
    const double size = kLeast + (kMost - kLeast) * (i / 2) / (kTurns - 1);
    const double turn = i % 2 == 0 ? size : -size;
    const double seen = start + seconds_to(turn) + kApproach;
    const Eigen::Vector3d camera = draft.orbit.world_from_camera(seen).translation;
    const Eigen::Vector2d side = Eigen::Rotation2Dd(from.yaw + turn) * body.telltale_side;
    const double facing = side.dot((camera.head<2>() - from.at).normalized());
    if (std::abs(facing - kBestFacing) >= nearest) continue;
    nearest = std::abs(facing - kBestFacing);
    best_turn = turn;
  }
  const double seconds = seconds_to(best_turn);
  add_move(draft, kBody, start, seconds, path_to(best_turn), {from.at, from.yaw + best_turn});
  if (grip) add_hand(draft, kBody, *grip, start, seconds);
  draft.events.push_back({SequenceKind::handle, kBody, start, start + seconds});
  return start + seconds;
}

}  // namespace bpa::sim
