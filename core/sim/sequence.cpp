// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/sequence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/concat.hpp"
#include "core/sim/arms.hpp"
#include "core/sim/private/draws.hpp"
#include "core/sim/private/sequence_draft.hpp"
#include "core/sim/private/telltales.hpp"

namespace bpa::sim {
namespace {

constexpr std::string_view kSequenceKindNames[] = {"mixed",  "standing", "moving_camera", "pushed",
                                                   "picked", "occluded", "twins",         "handle"};

// Streams of one sequence.
constexpr std::uint64_t kDropStream = 1, kSensorStream = 2, kImageStream = 3, kOrbitStream = 100;

constexpr double kClearance = 0.012;  // between bodies when they are placed, metres
// Radii of the disc that bodies are placed in, metres; the table has 0.45.
constexpr double kSmallestDisc = 0.2, kLargestDisc = 0.43;
constexpr int kPlacings = 20;         // of all bodies, until they have room
constexpr double kSmallTwin = 0.06;   // radius of objects that can pass each other, metres
constexpr double kHandleStart = 2.5;  // seconds that a handle stays hidden

Orbit draw_orbit(const SequenceOptions& options, std::uint64_t seed, int draw = 0) {
  constexpr double kRadians = std::numbers::pi / 180;
  const bool stands = options.kind == SequenceKind::standing;
  const SpeedLimits limits{stands ? 0 : options.camera_speed,
                           stands ? 0 : kRadians * options.camera_turn_deg};
  return {{options.min_distance, options.max_distance, kRadians * options.min_elevation_deg,
           kRadians * options.max_elevation_deg},
          limits,
          RandomStream(seed, kOrbitStream + static_cast<std::uint64_t>(draw))()};
}

/// The first of two bodies that are small enough to pass each other; -1 where there is none.
int find_small(const std::vector<TableBody>& bodies, int count) {
  int smallest = 0;
  for (int i = 0; i < count; ++i) {
    if (bodies[i].radius < kSmallTwin) return i;
    if (bodies[i].radius < bodies[smallest].radius) smallest = i;
  }
  return smallest;
}

std::vector<int> draw_objects(const Stage& stage, const SequenceOptions& options,
                              RandomStream& random) {
  const int span = std::max(options.max_objects - options.min_objects, 0) + 1;
  const int wanted = options.min_objects + random.index(span);
  std::vector<int> objects =
      chosen_without_repetition(wanted, static_cast<int>(stage.objects().size()), random);
  if (options.kind != SequenceKind::handle) return objects;
  // One whose telltales can be hidden comes first.
  std::vector<int> candidates;
  for (int i = 0; i < static_cast<int>(stage.objects().size()); ++i) {
    if (!stage.objects()[i].telltales.empty()) candidates.push_back(i);
  }
  const int chosen = candidates[random.index(static_cast<int>(candidates.size()))];
  const auto at = std::ranges::find(objects, chosen);
  if (at == objects.end()) {
    objects.front() = chosen;
  } else {
    std::iter_swap(objects.begin(), at);
  }
  return objects;
}

void draw_bodies(const Stage& stage, SequenceDraft& draft) {
  const bool handle = draft.options.kind == SequenceKind::handle;
  for (const int object : draw_objects(stage, draft.options, draft.random)) {
    const bool upright = handle && draft.bodies.empty();
    draft.bodies.push_back(body_at_rest(stage, object, upright, draft.random));
  }
  const bool twins = draft.options.kind == SequenceKind::twins ||
                     (draft.options.kind == SequenceKind::mixed && draft.random.index(3) == 0);
  draft.num_instances = static_cast<int>(draft.bodies.size());
  if (twins) {
    const int small = find_small(draft.bodies, draft.num_instances);
    std::swap(draft.bodies[0], draft.bodies[small]);
    // A copy of the first in place of the second, so that their number stays.
    if (draft.num_instances == 1) draft.bodies.emplace_back();
    draft.bodies[1] = draft.bodies[0];
    draft.num_instances = static_cast<int>(draft.bodies.size());
    draft.twin = 0;
  }
  const int first = static_cast<int>(stage.objects().size()) + kFirstDistractor;
  const int distractors = draft.random.index(draft.options.max_distractors + 1);
  for (const int i : chosen_without_repetition(distractors, kNumDistractors, draft.random)) {
    draft.bodies.push_back(body_at_rest(stage, first + i, false, draft.random));
  }
}

Place draw_place(SequenceDraft& draft, double radius) {
  const double r = radius * std::sqrt(draft.random.uniform());
  const double a = 2 * std::numbers::pi * draft.random.uniform();
  return {{r * std::cos(a), r * std::sin(a)},
          draft.random.uniform(-std::numbers::pi, std::numbers::pi)};
}

/// Two places to both sides of a point near the middle, and the disc that passing takes.
void place_twins(SequenceDraft& draft) {
  const double radius = draft.bodies[0].radius;
  const double half = radius + draft.random.uniform(0.02, 0.06);
  Place middle = draw_place(draft, 0.06);
  const Eigen::Vector2d direction(std::cos(middle.yaw), std::sin(middle.yaw));
  for (const double sign : {-1.0, 1.0}) {
    middle.yaw = draw_place(draft, 0).yaw;
    draft.places.push_back({middle.at + sign * half * direction, middle.yaw});
  }
  draft.reserved = Disc{middle.at, half + radius};
}

/// Places bodies one by one, the largest first, in a disc that grows where it is full. False where
/// there was no room.
bool place_bodies(SequenceDraft& draft) {
  constexpr int kTries = 60;
  const Place nowhere{{1e3, 1e3}, 0};
  draft.disc = kSmallestDisc;
  draft.places.clear();
  if (draft.twin) place_twins(draft);
  if (draft.options.kind == SequenceKind::handle) draft.places.push_back(draw_place(draft, 0.04));
  std::vector<int> order(draft.bodies.size() - draft.places.size());
  std::iota(order.begin(), order.end(), static_cast<int>(draft.places.size()));
  std::ranges::stable_sort(order, std::ranges::greater(),
                           [&](int i) { return draft.bodies[i].radius; });
  draft.places.resize(draft.bodies.size(), nowhere);
  for (const int i : order) {
    const double radius = draft.bodies[i].radius;
    Place place;
    int tries = 0;
    do {
      if (++tries % kTries == 0) draft.disc += 0.01;
      if (draft.disc > kLargestDisc) return false;
      place = draw_place(draft, std::max(draft.disc - radius, 0.0));
    } while (!draft.is_free({place.at, radius + kClearance}, i));
    draft.places[i] = place;
  }
  return true;
}

/// The largest share of body 0's telltales that is in sight while they must be hidden.
double most_in_sight(const Stage& stage, const SequenceDraft& draft, const Place& place) {
  constexpr int kTimes = 6;
  const TableBody& body = draft.bodies[0];
  const RayScene scene(stage.meshes(),
                       {{body.mesh, world_from_rest(place) * body.rest_from_object}});
  double most = 0;
  for (int k = 0; k < kTimes; ++k) {
    const Pose camera = draft.orbit.world_from_camera(kHandleStart * k / (kTimes - 1));
    most = std::max(most,
                    telltales_in_sight(stage.body(body.mesh), scene, draft.options.camera, camera));
  }
  return most;
}

/// Draws the camera's orbit anew, and turns body 0, until next to nothing of its telltales is in
/// sight while they must be hidden. Keeps the best where none hides them so well.
void hide_telltales(const Stage& stage, SequenceDraft& draft, std::uint64_t seed) {
  constexpr int kYaws = 24, kOrbits = 60;
  constexpr double kHidden = 0.01;  // share of vertices; the top of a mug's handle, over its rim
  Orbit best_orbit = draft.orbit;
  Place best = draft.places[0];
  double least = 2;
  for (int i = 0; i < kOrbits && least > kHidden; ++i) {
    draft.orbit = draw_orbit(draft.options, seed, i);
    for (int k = 0; k < kYaws && least > kHidden; ++k) {
      Place place = draft.places[0];
      place.yaw += 2 * std::numbers::pi * k / kYaws;
      const double seen = most_in_sight(stage, draft, place);
      if (seen >= least) continue;
      least = seen;
      best = place;
      best_orbit = draft.orbit;
    }
  }
  draft.orbit = best_orbit;
  draft.places[0] = best;
}

using AddEvent = std::optional<double> (*)(SequenceDraft&, double);

std::vector<AddEvent> draw_cycle(SequenceDraft& draft) {
  switch (draft.options.kind) {
    case SequenceKind::standing:
    case SequenceKind::moving_camera:
      return {};
    case SequenceKind::pushed:
      return {add_push};
    case SequenceKind::picked:
      return {add_pick};
    case SequenceKind::occluded:
      return {add_occlusion};
    case SequenceKind::twins:
      return {add_passing};
    case SequenceKind::handle:
    case SequenceKind::mixed:
      break;
  }
  std::vector<AddEvent> events = {add_push, add_pick, add_occlusion};
  if (draft.twin) events.push_back(add_passing);
  std::vector<AddEvent> cycle;
  for (const int i : chosen_without_repetition(static_cast<int>(events.size()),
                                               static_cast<int>(events.size()), draft.random)) {
    cycle.push_back(events[i]);
  }
  return cycle;
}

void add_events(SequenceDraft& draft) {
  constexpr double kBefore = 1.2;  // an arm comes from out of sight meanwhile
  const std::vector<AddEvent> cycle = draw_cycle(draft);
  double start = kBefore + draft.random.uniform(0, 0.5);
  if (draft.options.kind == SequenceKind::handle) {
    start = add_turn(draft, kHandleStart).value() + kBefore;
  }
  int failed = 0;  // in a row
  const int count = static_cast<int>(cycle.size());
  for (int i = 0; failed < count && start < draft.options.seconds; ++i) {
    const std::optional<double> end = cycle[i % count](draft, start);
    failed = end ? 0 : failed + 1;
    if (end) start = *end + draft.random.uniform(0.9, 1.5);
  }
}

std::vector<SequenceFrame> frames_of(const Stage& stage, const SequenceDraft& draft, int table,
                                     std::uint64_t seed) {
  const int num_objects = static_cast<int>(stage.objects().size());
  const int first_arm = num_objects + static_cast<int>(stage.scenery().size()) - kNumArms;
  RandomStream dropping(seed, kDropStream);
  std::vector<SequenceFrame> frames;
  const int count =
      std::max(1, static_cast<int>(std::lround(draft.options.seconds * draft.options.rate)));
  for (int i = 0; i < count; ++i) {
    SequenceFrame& frame = frames.emplace_back();
    const double t = i / draft.options.rate;
    frame.stamp_ns = std::llround(1e9 * t);
    frame.dropped = dropping.uniform() < draft.options.drop && i > 0;
    frame.world_from_camera = draft.orbit.world_from_camera(t);
    for (std::size_t k = 0; k < draft.bodies.size(); ++k) {
      const TableBody& body = draft.bodies[k];
      frame.bodies.push_back(
          {body.mesh, draft.world_from_rest_at(static_cast<int>(k), t) * body.rest_from_object});
    }
    frame.bodies.push_back({num_objects + kFirstTable + table, Pose{}});
    frame.bodies.push_back({num_objects + kRoom, Pose{}});
    for (const ArmVisit& visit : draft.visits) {
      if (t < visit.start || t > visit.end) continue;
      frame.bodies.push_back({first_arm + visit.arm, visit.world_from_arm(t)});
    }
  }
  return frames;
}

Status check_options(const Stage& stage, SequenceOptions options) {
  if (Status status = validate(options); !status.ok()) return status;
  const auto check = [](const char* name, auto low, auto high) -> Status {
    if (low <= high) return {};
    return invalid_argument("min_", name, " = ", low, " must not be larger than max_", name, " = ",
                            high);
  };
  Status status = check("objects", options.min_objects, options.max_objects);
  if (status.ok()) status = check("distance", options.min_distance, options.max_distance);
  if (status.ok()) {
    status = check("elevation_deg", options.min_elevation_deg, options.max_elevation_deg);
  }
  if (!status.ok()) return status;
  const auto shows_all = [](const SimulatedObject& object) { return object.telltales.empty(); };
  if (options.kind == SequenceKind::handle && std::ranges::all_of(stage.objects(), shows_all)) {
    return invalid_argument(
        "kind = handle: no object has a part that tells its sides apart, as a mug's handle");
  }
  return {};
}

}  // namespace

std::string_view name_of(SequenceKind kind) { return kSequenceKindNames[static_cast<int>(kind)]; }

std::optional<SequenceKind> sequence_kind(std::string_view name) {
  for (const SequenceKind kind : kSequenceKinds) {
    if (name == name_of(kind)) return kind;
  }
  return std::nullopt;
}

SpeedLimits SequenceDraft::object_limits() {
  const double share = random.uniform(0.5, 0.98);
  return {share * options.object_speed, share * options.object_turn_deg * std::numbers::pi / 180};
}

bool SequenceDraft::is_free(const Disc& wanted, int self) const {
  if (reserved && !is_twin(self) && reserved->overlaps(wanted)) return false;
  for (int i = 0; i < static_cast<int>(places.size()); ++i) {
    if (i != self && wanted.overlaps({places[i].at, bodies[i].radius})) return false;
  }
  return true;
}

Pose SequenceDraft::world_from_rest_at(int body, double seconds) const {
  Pose pose = world_from_rest(first_places[body]);
  for (const Move& move : moves[body]) {
    if (seconds < move.start) break;
    pose = move.world_from_rest(std::min(1.0, (seconds - move.start) / move.seconds));
  }
  return pose;
}

Stage sequence_stage(std::vector<SimulatedObject> objects, int num_threads) {
  return Stage(std::move(objects), num_threads, make_arms());
}

Result<Sequence> plan_sequence(const Stage& stage, const SequenceOptions& options,
                               std::uint64_t seed) {
  if (Status status = check_options(stage, options); !status.ok()) return status;
  SequenceDraft draft(options, RandomStream(seed, 0), draw_orbit(options, seed));
  draw_bodies(stage, draft);
  int tries = 0;
  while (!place_bodies(draft)) {
    if (++tries < kPlacings) continue;
    return invalid_argument(
        concat("max_objects = ", options.max_objects, ": the table has no room for so many"));
  }
  if (options.kind == SequenceKind::handle) hide_telltales(stage, draft, seed);
  draft.first_places = draft.places;
  draft.moves.resize(draft.bodies.size());
  add_events(draft);

  Sequence sequence;
  sequence.kind = options.kind;
  sequence.sensor = options.sensor;
  if (options.mixed_sensors) {
    sequence.sensor.kind =
        static_cast<SensorKind>(RandomStream(seed, kSensorStream).index(kSensorKinds.size()));
  }
  sequence.camera = options.camera;
  sequence.seed = RandomStream(seed, kImageStream)();
  for (int i = 0; i < draft.num_instances; ++i) sequence.objects.push_back(draft.bodies[i].mesh);
  sequence.shading = draw_shading(draft.random);
  sequence.frames = frames_of(stage, draft, draft.random.index(kNumTables), seed);
  sequence.events = std::move(draft.events);
  return sequence;
}

SimulatedFrame capture_frame(const Stage& stage, const Sequence& sequence, int frame,
                             int num_threads) {
  const SequenceFrame& at = sequence.frames[frame];
  Shading shading = sequence.shading;
  for (const PosedMesh& body : at.bodies) {
    shading.materials.push_back(stage.body(body.mesh).material);
  }
  const RayScene scene(stage.meshes(), at.bodies);
  const SensorView view{scene, shading, sequence.camera, at.world_from_camera};
  SimulatedFrame captured =
      capture(view, sequence.objects, sequence.sensor, sequence.seed, frame, num_threads);
  captured.frame.stamp_ns = at.stamp_ns;
  return captured;
}

}  // namespace bpa::sim
