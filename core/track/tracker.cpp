// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/base/stopwatch.hpp"
#include "core/cloud/planes.hpp"
#include "core/cloud/sensor_noise.hpp"
#include "core/detect/candidate.hpp"
#include "core/track/background.hpp"
#include "core/track/history.hpp"
#include "core/track/life.hpp"
#include "core/track/newcomer.hpp"
#include "core/track/observe.hpp"

namespace bpa::track {
namespace {

// Chosen by hand.
constexpr int kAbsentFrames = 5;      // in a row: the track is lost
constexpr double kMinSearched = 0.3;  // visible fraction of what a search should find
constexpr int kDisplaced = 2;  // searches in a row that find an object elsewhere alone: it is there
// Log odds that an object is there, by a search that should find it and does not: 19/732 searches
// of true tracks, 13/27 of false ones in six simulated sequences, log ratio -2.9. Misses come in a
// row, so that less counts.
constexpr double kNotFound = -2;
constexpr double kOtherFound = -3;  // of one that finds another object in its place
constexpr double kEnds = -0.5;      // below this a track ends
constexpr int kNewlySeen = 15;      // alignments since it came into sight
// Newcomers that a frame brings on, and frames that each goes through then.
constexpr std::size_t kReceivedAtOnce = 3, kStepsAFrame = 4;
constexpr double kMostRested_s = 0.3;  // that resting objects are not aligned
// Modes and newcomers take turns, so that no frame takes long: of four frames in a row, three bring
// newcomers on and one compares modes. By hand.
constexpr int kNewcomersTurns = 3;

}  // namespace

struct Tracker::State {
  std::shared_ptr<const ModelLibrary> library;
  TrackerOptions options;
  score::ScoreLayers layers;
  TrackerCounts counts;
  std::optional<SensorKind> sensor;
  std::string frame_id;  // of the tracks; the camera's where its pose is not known
  bool in_fixed_frame = false;
  std::int64_t stamp_ns = 0;
  Pose frame_from_camera;
  std::optional<SceneFeatures> scene;  // of the newest frame, once it is needed
  double rested_s = 0;                 // since resting objects were aligned
  Background background;
  History history;
  std::vector<Life> tracks;       // by id
  std::vector<EndedTrack> ended;  // since the last frame
  std::vector<SceneInterpretations> results;
  std::vector<Newcomer> newcomers;  // in the order of their results
  bool newcomers_wait = false;      // in the newest frame
  int newcomers_turns = 0;          // frames in a row
  std::uint64_t last_id = 0;
  std::map<std::string, int> born_of_model;

  // The newest frame. It is observed once, if at all.
  ObservedFrame observed(const Frame& frame) {
    if (!scene) {
      std::vector<Plane> planes;
      for (const Plane& plane : background.planes()) {
        planes.push_back(transformed(frame_from_camera.inverse(), plane));
      }
      scene = observe(frame, *sensor, planes, options.num_threads);
    }
    return {frame, *scene, frame_from_camera, layers};
  }

  // Ends all tracks, and forgets frames and results.
  void begin_anew(const std::string& reason) {
    for (const Life& life : tracks) end(life, reason);
    tracks.clear();
    history.clear();
    background.clear();
    results.clear();
    newcomers.clear();
  }

  // The next frame's result says it.
  void end(const Life& life, const std::string& reason) {
    ended.push_back({life.id, life.name, reason});
    ++counts.ends;
  }

  // Resting objects whose surroundings have not changed are left where they are, for a while.
  void follow_all(const Frame& frame, double passed_s) {
    std::vector<std::uint8_t> rests(tracks.size());
    rested_s += passed_s;
    const bool may_rest = rested_s < kMostRested_s;
    parallel_for(tracks.size(), options.num_threads, [&](std::size_t i) {
      Body& body = tracks[i].body;
      predict(passed_s, body);
      rests[i] = may_rest && looks_unchanged(frame, noise_of(*sensor), frame_from_camera, body);
    });
    const bool all = std::ranges::count(rests, 0) == 0;
    if (!may_rest) rested_s = 0;
    newcomers_wait = false;
    if (all) return;
    const ObservedFrame now = observed(frame);
    const bool none_new = newcomers.empty() && results.empty();
    newcomers_wait = !none_new && ++newcomers_turns > kNewcomersTurns;
    const bool modes_turn = none_new || newcomers_wait;
    if (modes_turn) newcomers_turns = 0;
    parallel_for(tracks.size(), options.num_threads, [&](std::size_t i) {
      if (rests[i]) return;
      correct(now, tracks[i].body);
      if (modes_turn) compare_modes(now, tracks[i].body);
    });
  }

  // Two tracks of one model in one place. One that has just come into sight there is behind the
  // other. Else they are one object: the one that searches have found less ends.
  void part_twins() {
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      for (std::size_t k = i + 1; k < tracks.size(); ++k) {
        Life &a = tracks[i], &b = tracks[k];
        if (a.body.model != b.body.model || a.body.sight != Sight::seen ||
            b.body.sight != Sight::seen) {
          continue;
        }
        if (!in_one_place(*a.body.model, a.body.motion.pose(), b.body.motion.pose())) continue;
        Life& latest = a.body.seen < b.body.seen ? a : b;
        const Life& first = &latest == &a ? b : a;
        if (latest.body.seen < kNewlySeen && first.body.seen >= kNewlySeen &&
            latest.state == TrackState::occluded) {
          take_back(latest.body);
          continue;
        }
        Life& other = b.found > 1 && b.evidence > a.evidence ? a : b;
        other.ends = concat("is ", &other == &a ? b.name : a.name);
      }
    }
  }

  void update_states() {
    for (Life& life : tracks) {
      const Body& body = life.body;
      life.absent = body.sight == Sight::absent ? life.absent + 1 : 0;
      const bool was_lost = life.state == TrackState::lost;
      if (body.sight == Sight::seen) {
        life.seen_ns = stamp_ns;
        if (was_lost) ++counts.found_again;
      } else if (life.absent >= kAbsentFrames && !was_lost) {
        life.state = TrackState::lost;
        ++counts.losses;
      } else if (body.sight == Sight::hidden && life.state == TrackState::confirmed) {
        life.state = TrackState::occluded;
      }
      confirm(life);
      if (life.held) continue;
      const double unseen = seconds(stamp_ns - life.seen_ns);
      const double limit = life.state == TrackState::occluded ? options.hidden_s : options.lost_s;
      if (unseen > limit) life.ends = concat("not seen for ", limit, " s");
      if (life.evidence < kEnds) life.ends = "searches do not find it";
    }
  }

  void confirm(Life& life) {
    if (life.confirm(options.min_confirming)) ++counts.confirmed;
  }

  Life* life_of(std::uint64_t id) {
    const auto found = std::ranges::find(tracks, id, &Life::id);
    return found == tracks.end() ? nullptr : &*found;
  }

  // A search has found a track, which may have gone out of sight.
  void find_again(const Placement& found, const TrackRecord& record, const FrameRecord& at,
                  bool partial, Life& life) {
    if (life.body.sight != Sight::seen) return expect(found, life.id, at);
    if (partial) return;  // poses are compared in its final stages
    life.suggest(found, life.body.motion.pose() * record.camera_from_object.inverse());
  }

  // The index of a track of the model at the pose; -1: none.
  int track_at(const std::string& model, const Pose& pose) const {
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      const Body& body = tracks[i].body;
      if (body.model->name != model) continue;
      if (in_one_place(*body.model, body.motion.pose(), pose)) return static_cast<int>(i);
    }
    return -1;
  }

  // The placement is followed to the newest frame, in this and the next ones, unless it is on its
  // way already.
  void expect(const Placement& found, std::uint64_t track, const FrameRecord& at) {
    const bool known = std::ranges::any_of(newcomers, [&](const Newcomer& other) {
      return other.stamp_ns() == at.stamp_ns && other.found().model == found.model &&
             in_one_place(other.model(), other.start(),
                          at.frame_from_camera * found.frame_from_object);
    });
    if (known) return;
    if (auto model = library->find(found.model)) {
      newcomers.emplace_back(found, std::move(model), track, at);
    }
  }

  // Begins tracks of newcomers that have arrived.
  void receive(const Frame& newest) {
    // A track may have been born after the search's frame.
    std::erase_if(newcomers, [&](const Newcomer& newcomer) {
      const int there = track_at(newcomer.found().model, newcomer.start());
      const bool known = newcomer.track() == 0 && there >= 0;
      if (known) {
        tracks[there].believe(newcomer.found(), newcomer.stamp_ns());
        tracks[there].suggest(newcomer.found(), newcomer.frame_from_camera());
      }
      return known;
    });
    if (!newcomers.empty() && !newcomers_wait) bring_on(observed(newest));
  }

  void bring_on(const ObservedFrame& newest) {
    const auto some = std::span(newcomers).first(std::min(newcomers.size(), kReceivedAtOnce));
    const auto since = history.kept_after(std::ranges::min(some, {}, &Newcomer::at_ns).at_ns());
    std::vector<Newcomer::Progress> progress(some.size());
    parallel_for(some.size(), options.num_threads,
                 [&](std::size_t i) { progress[i] = some[i].step(since, newest, kStepsAFrame); });
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (progress[i] == Newcomer::Progress::arrived) add_arrived(some[i]);
    }
    std::size_t i = 0;
    std::erase_if(newcomers, [&](const Newcomer&) {
      return i < progress.size() && progress[i++] != Newcomer::Progress::on_the_way;
    });
  }

  void add_arrived(Newcomer& newcomer) {
    const Pose since = newcomer.now_from_then();
    Body body = newcomer.take_body();
    const int there = track_at(newcomer.found().model, body.motion.pose());
    if (newcomer.track() > 0) {
      const bool taken = there >= 0 && tracks[there].id != newcomer.track() &&
                         tracks[there].body.sight == Sight::seen;
      if (taken) return;  // it was led to another object on its way
      Life* life = life_of(newcomer.track());
      const bool gone = life && (life->body.sight != Sight::seen || life->missed >= kDisplaced);
      if (gone && body.sight == Sight::seen) life->body = std::move(body);
      return;
    }
    if (there < 0) return add_track(newcomer.found(), newcomer.stamp_ns(), std::move(body));
    tracks[there].believe(newcomer.found(), newcomer.stamp_ns());
    tracks[there].suggest(newcomer.found(), since);
  }

  void add_track(const Placement& found, std::int64_t stamp, Body body) {
    std::string name;
    do {
      name = concat(found.model, "_", ++born_of_model[found.model]);
    } while (std::ranges::count(tracks, name, &Life::name) > 0);
    Life life{.id = ++last_id, .name = std::move(name), .body = std::move(body)};
    life.believe(found, stamp);
    life.born_ns = stamp_ns;
    life.seen_ns = stamp_ns;
    ++counts.births;
    confirm(life);
    tracks.push_back(std::move(life));
  }

  // In the first kept frame since a search's.
  void find_background(std::int64_t stamp) {
    const std::span<const KeptFrame> since = history.kept_after(stamp - 1);
    if (since.empty()) return;
    background.find(*since.front().frame, *sensor, since.front().frame_from_camera);
  }

  // Later stages of the search may still reject the placement, and compare other poses.
  bool is_early(const SceneInterpretations& result, const Placement& found) const {
    return result.partial && found.probability < options.min_confirming;
  }

  void take(const SceneInterpretations& result) {
    const FrameRecord* record = history.record_of(result.stamp_ns);
    if (!record || result.interpretations.empty()) return;
    if (!result.partial || background.planes().empty()) find_background(result.stamp_ns);
    const std::vector<Placement> placements =
        found_objects(result, *library, options.min_probability);
    const std::vector<int> matched = match_tracks(placements, record->tracks);
    for (std::size_t t = 0; t < record->tracks.size(); ++t) {
      const TrackRecord& track = record->tracks[t];
      Life* life = life_of(track.id);
      if (!life) continue;
      const auto by = std::ranges::find(matched, static_cast<int>(t));
      if (by != matched.end()) {
        const Placement& found = placements[by - matched.begin()];
        if (!is_early(result, found)) life->believe(found, record->stamp_ns);
        find_again(found, track, *record, result.partial, *life);
        continue;
      }
      if (result.partial) continue;
      const bool taken = std::ranges::any_of(
          placements, [&](const Placement& p) { return claims_place(p, track); });
      if (result.budget_exhausted && !taken) continue;
      if (!should_be_found(track)) continue;
      life->doubt(taken ? kOtherFound : kNotFound);
    }
    for (std::size_t p = 0; p < placements.size(); ++p) {
      if (matched[p] < 0 && !is_early(result, placements[p])) {
        meet(placements[p], *record, matched);
      }
    }
  }

  // A placement without a track. It may be of a track of the model that should have been found and
  // was not, so that it follows another surface: another search decides.
  void meet(const Placement& found, const FrameRecord& record, const std::vector<int>& matched) {
    for (std::size_t t = 0; t < record.tracks.size(); ++t) {
      const TrackRecord& track = record.tracks[t];
      if (track.model->name != found.model || !should_be_found(track)) continue;
      if (std::ranges::count(matched, static_cast<int>(t)) > 0) continue;
      const Life* life = life_of(track.id);
      if (!life) continue;
      if (life->missed >= kDisplaced) expect(found, life->id, record);
      return;
    }
    expect(found, 0, record);
  }

  static bool should_be_found(const TrackRecord& track) {
    return track.sight == Sight::seen && track.visible_fraction >= kMinSearched;
  }

  void remember(std::shared_ptr<const Frame> frame) {
    std::vector<TrackRecord> where;
    for (const Life& life : tracks) {
      where.push_back({life.id, life.body.model,
                       frame_from_camera.inverse() * life.body.motion.pose(), life.body.sight,
                       life.body.visible_fraction, seconds(stamp_ns - life.seen_ns)});
    }
    history.remember(std::move(frame), frame_from_camera, std::move(where));
  }

  Result<Life*> named(std::uint64_t id) {
    if (Life* life = life_of(id)) return life;
    std::string there;
    for (const Life& life : tracks)
      there += concat(there.empty() ? "" : ", ", life.id, " (", life.name, ")");
    return not_found("no track has the id ", id, "; there are: ", there.empty() ? "none" : there);
  }
};

Tracker::Tracker(std::shared_ptr<const ModelLibrary> library, TrackerOptions options,
                 score::ScoreLayers layers)
    : state_(std::make_unique<State>()) {
  state_->library = std::move(library);
  state_->options = options;
  state_->layers = std::move(layers);
}

Tracker::~Tracker() = default;

Result<TrackedFrame> Tracker::track(std::shared_ptr<const Frame> frame,
                                    const std::optional<CameraPose>& camera) {
  State& s = *state_;
  if (Status status = validate(*frame); !status.ok()) return status;
  if (s.stamp_ns != 0 && frame->stamp_ns <= s.stamp_ns) {
    return invalid_argument("the frame's stamp, ", frame->stamp_ns,
                            " ns, is not later than that of the frame before, ", s.stamp_ns, " ns");
  }
  const Stopwatch watch;
  const std::string& id = camera ? camera->frame_id : frame->frame_id;
  if (id != s.frame_id || camera.has_value() != s.in_fixed_frame) {
    s.begin_anew("the poses' frame of reference is now " + id);
    s.frame_id = id;
    s.in_fixed_frame = camera.has_value();
  }
  if (!s.sensor) s.sensor = sensor_kind_of(sensor_traits(*frame));
  const double passed_s = seconds(frame->stamp_ns - s.stamp_ns);  // of use where there are tracks
  s.stamp_ns = frame->stamp_ns;
  s.frame_from_camera = camera ? camera->fixed_from_camera : Pose();
  ++s.counts.frames;
  if (!camera) s.background.check(*frame, s.frame_from_camera);
  s.follow_all(*frame, passed_s);
  s.part_twins();
  s.update_states();
  for (const SceneInterpretations& result : std::exchange(s.results, {})) s.take(result);
  s.receive(*frame);
  s.scene.reset();

  TrackedFrame out{.stamp_ns = s.stamp_ns,
                   .frame_id = s.frame_id,
                   .camera_frame_id = frame->frame_id,
                   .in_fixed_frame = s.in_fixed_frame,
                   .frame_from_camera = s.frame_from_camera};
  for (const Life& life : s.tracks) {
    if (life.ends.empty()) {
      out.tracks.push_back(report(life, s.stamp_ns));
    } else {
      s.end(life, life.ends);
    }
  }
  std::erase_if(s.tracks, [](const Life& life) { return !life.ends.empty(); });
  out.ended = std::exchange(s.ended, {});
  s.remember(std::move(frame));
  out.milliseconds = watch.milliseconds();
  return out;
}

void Tracker::begin_anew(const std::string& reason) {
  State& s = *state_;
  s.begin_anew(reason);
  s.stamp_ns = 0;
  s.sensor.reset();
  s.born_of_model.clear();
}

Status Tracker::add(const SceneInterpretations& found) {
  State& s = *state_;
  if (!s.history.record_of(found.stamp_ns)) {
    s.counts.stale_searches += found.partial ? 0 : 1;
    return not_found("no frame with the stamp ", found.stamp_ns, " ns was followed in the last ",
                     History::kRemembered_s, " s");
  }
  s.counts.searches += found.partial ? 0 : 1;
  if (const auto kind = sensor_kind(found.sensor)) s.sensor = kind;
  s.results.push_back(found);
  return {};
}

double Tracker::changed_since(std::int64_t stamp_ns) const {
  const FrameRecord* then = state_->history.record_of(stamp_ns);
  if (!then) return 1;
  return changed_share(state_->history.newest().depths, then->depths, noise_of(*state_->sensor));
}

std::vector<ExpectedPlacement> Tracker::expected() const {
  std::vector<ExpectedPlacement> out;
  for (const Life& life : state_->tracks) {
    if (life.state != TrackState::confirmed || life.body.sight != Sight::seen) continue;
    out.push_back(
        {life.body.model->name, state_->frame_from_camera.inverse() * life.body.motion.pose()});
  }
  return out;
}

Status Tracker::rename(std::uint64_t id, const std::string& name) {
  Result<Life*> life = state_->named(id);
  if (!life.ok()) return life.status();
  if (name.empty()) return invalid_argument("the name of a track is empty");
  for (const Life& other : state_->tracks) {
    if (other.id != id && other.name == name) {
      return invalid_argument("track ", other.id, " has the name \"", name, "\" already");
    }
  }
  (*life)->name = name;
  return {};
}

Status Tracker::hold(std::uint64_t id, bool held) {
  Result<Life*> life = state_->named(id);
  if (!life.ok()) return life.status();
  (*life)->held = held;
  return {};
}

Status Tracker::forget(std::uint64_t id) {
  Result<Life*> life = state_->named(id);
  if (!life.ok()) return life.status();
  (*life)->ends = "forgotten by request";
  return {};
}

const TrackerOptions& Tracker::options() const { return state_->options; }
void Tracker::set_options(const TrackerOptions& options) { state_->options = options; }

void Tracker::set_library(std::shared_ptr<const ModelLibrary> library, score::ScoreLayers layers) {
  State& s = *state_;
  s.library = std::move(library);
  s.layers = std::move(layers);
  for (Life& life : s.tracks) {
    if (s.library->find(life.body.model->name) != life.body.model) {
      life.ends = "its model is no longer in the library";
    }
  }
}

const TrackerCounts& Tracker::counts() const { return state_->counts; }

}  // namespace bpa::track
