// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/track_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/eval/private/track_counter.hpp"

namespace bpa::eval {
namespace {

constexpr std::size_t kAddsPoints = 2600;  // YCB-Video's points.xyz have about as many
constexpr int kLevel95 = 2;                // of kCredibleLevels

bool is_reported(const Track& track) {
  return track.state == TrackState::confirmed || track.state == TrackState::occluded;
}

/// The truth of a sequence's frames, with what counts.
std::vector<TrackFrame> truth_of(const std::vector<const io::BopFrame*>& frames,
                                 const TrackEvaluationOptions& options) {
  std::vector<TrackFrame> result(frames.size());
  std::map<int, std::int64_t> last_seen;  // stamps by identity
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (const io::BopInstance& instance : frames[i]->truth) {
      const std::int64_t now = frames[i]->stamp_ns;
      Visibility visibility = Visibility::ignored;
      const auto seen = last_seen.find(instance.instance);
      if (instance.visible_fraction >= options.min_visible_fraction) {
        visibility = Visibility::visible;
        last_seen[instance.instance] = now;
      } else if (seen != last_seen.end() &&
                 1e-9 * static_cast<double>(now - seen->second) <= options.hidden_s) {
        visibility = Visibility::hidden;
      }
      result[i].truth.push_back(
          {instance.obj_id, instance.instance, instance.camera_from_object, visibility});
    }
  }
  return result;
}

/// Some of an object's vertices.
using SomePoints = std::map<int, Points>;

SomePoints some_points(const EvalObjects& objects) {
  SomePoints result;
  for (const auto& [obj_id, object] : objects) {
    const Points& all = object.mesh.vertices;
    const std::size_t step = (all.size() + kAddsPoints - 1) / kAddsPoints;
    for (std::size_t i = 0; i < all.size(); i += step) result[obj_id].push_back(all[i]);
  }
  return result;
}

NearPair near_pair(const Track& track, const Pose& frame_from_camera, const TrackedTruth& truth,
                   const EvalObject& object, const Points& points, double match_m) {
  NearPair pair;
  const Pose frame_from_truth = frame_from_camera * truth.camera_from_object;
  const Pose& pose = track.frame_from_object;
  const double distance = pose_error(pose, frame_from_truth, object.symmetry).position;
  if (distance > match_m) return pair;
  pair.distance = distance;
  pair.adds = average_nearest_distance(points, pose, frame_from_truth);
  pair.right = is_right(pose, frame_from_truth, object.symmetry);
  if (track.state == TrackState::confirmed) {
    const Pose nearest = nearest_symmetric_pose(frame_from_truth, pose, object.symmetry);
    pair.covariance_error = covariance_error(pose, track.covariance, nearest, object.symmetry);
  }
  return pair;
}

void add_estimates(const io::TrackResult& result, const EvalObjects& objects,
                   const SomePoints& points, double match_m, TrackFrame& frame) {
  for (const Track& track : result.tracks) {
    if (!is_reported(track)) continue;
    frame.estimates.push_back(track.id);
    std::vector<NearPair>& row = frame.pairs.emplace_back(frame.truth.size());
    for (std::size_t t = 0; t < frame.truth.size(); ++t) {
      const int object = frame.truth[t].object;
      if (object != track.model_number) continue;
      row[t] = near_pair(track, result.frame_from_camera, frame.truth[t], objects.at(object),
                         points.at(object), match_m);
    }
  }
}

void add_visible_frame(const TrackFrame& frame, const std::vector<int>& matches, bool last,
                       TrackMeasures& measures) {
  int right = 0;
  for (std::size_t e = 0; e < matches.size(); ++e) {
    if (matches[e] < 0) continue;
    const NearPair& pair = frame.pairs[e][matches[e]];
    right += pair.right;
    if (!pair.covariance_error) continue;
    const auto [squared, degrees_of_freedom] = *pair.covariance_error;
    measures.nees_sum += squared / degrees_of_freedom;
    ++measures.nees_within.total;
    measures.nees_within.hits += squared <= chi_squared_quantile(kLevel95, degrees_of_freedom);
  }
  if (!last) return;
  measures.right_at_end.hits = right;
  measures.right_at_end.total = static_cast<int>(
      std::ranges::count(frame.truth, Visibility::visible, &TrackedTruth::visibility));
}

void add_hidden_frame(const TrackFrame& frame, const std::vector<int>& matches,
                      TrackMeasures& measures) {
  for (std::size_t t = 0; t < frame.truth.size(); ++t) {
    if (frame.truth[t].visibility != Visibility::hidden) continue;
    ++measures.hidden_held.total;
    measures.hidden_held.hits += std::ranges::count(matches, static_cast<int>(t)) > 0;
  }
}

TrackMeasures measured(const std::vector<TrackFrame>& frames) {
  TrackMeasures measures;
  measures.frames = static_cast<int>(frames.size());
  TrackCounter visible(false), all(true);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    add_visible_frame(frames[i], visible.add(frames[i]), i + 1 == frames.size(), measures);
    add_hidden_frame(frames[i], all.add(frames[i]), measures);
  }
  measures.visible = visible.finished();
  measures.all = all.finished();
  return measures;
}

void add_ratio(Ratio& sum, const Ratio& ratio) {
  sum.hits += ratio.hits;
  sum.total += ratio.total;
}

void add_measures(TrackMeasures& total, const TrackMeasures& sequence) {
  total.frames += sequence.frames;
  total.visible += sequence.visible;
  total.all += sequence.all;
  add_ratio(total.hidden_held, sequence.hidden_held);
  add_ratio(total.right_at_end, sequence.right_at_end);
  total.nees_sum += sequence.nees_sum;
  add_ratio(total.nees_within, sequence.nees_within);
  total.milliseconds.insert(total.milliseconds.end(), sequence.milliseconds.begin(),
                            sequence.milliseconds.end());
}

using FrameKey = std::pair<int, int>;  // scene_id, im_id
using ResultsByFrame = std::map<FrameKey, const io::TrackResult*>;

std::string name_of_frame(const FrameKey& key) {
  return "scene " + std::to_string(key.first) + " image " + std::to_string(key.second);
}

Status check_truth(const std::vector<io::BopFrame>& frames, const EvalObjects& objects) {
  for (const io::BopFrame& frame : frames) {
    const std::string name = name_of_frame({frame.scene_id, frame.im_id});
    std::set<int> identities;
    for (const io::BopInstance& instance : frame.truth) {
      if (instance.instance == 0 || !identities.insert(instance.instance).second) {
        return invalid_argument(
            "the truth of ", name,
            " has an instance without an instance_id of its own; tracks need it");
      }
      if (!objects.contains(instance.obj_id)) {
        return invalid_argument("the truth of ", name, " has obj_id ", instance.obj_id,
                                ", which is not among the models");
      }
    }
    if (!frame.has_truth) return invalid_argument(name, " has no truth (scene_gt.json)");
  }
  return {};
}

Result<ResultsByFrame> by_frame(const std::vector<io::BopFrame>& frames, const EvalObjects& objects,
                                const std::vector<io::TrackResult>& results) {
  std::set<FrameKey> known;
  for (const io::BopFrame& frame : frames) known.insert({frame.scene_id, frame.im_id});
  ResultsByFrame found;
  for (const io::TrackResult& result : results) {
    const FrameKey key{result.scene_id, result.im_id};
    if (!known.contains(key)) {
      return invalid_argument("the tracks have ", name_of_frame(key),
                              ", which is not in the data set");
    }
    for (const Track& track : result.tracks) {
      if (objects.contains(track.model_number)) continue;
      return invalid_argument("the tracks have obj_id ", track.model_number,
                              ", which is not among the data set's models");
    }
    found[key] = &result;
  }
  return found;
}

}  // namespace

double TrackCounts::mota() const {
  const int wrong = instances - matched + false_reports + switches;
  return instances > 0 ? 1 - static_cast<double>(wrong) / instances : 0;
}

double TrackCounts::motp_m() const { return matched > 0 ? distance_sum / matched : 0; }

double TrackCounts::idf1() const {
  const int both = instances + estimates();
  return both > 0 ? 2.0 * identity_matched / both : 0;
}

double TrackCounts::adds_auc() const { return instances > 0 ? adds_area_sum / instances : 0; }

TrackCounts& TrackCounts::operator+=(const TrackCounts& other) {
  for (const auto member :
       {&TrackCounts::instances, &TrackCounts::matched, &TrackCounts::false_reports,
        &TrackCounts::switches, &TrackCounts::objects, &TrackCounts::identity_matched,
        &TrackCounts::within_2cm, &TrackCounts::right}) {
    this->*member += other.*member;
  }
  distance_sum += other.distance_sum;
  adds_area_sum += other.adds_area_sum;
  return *this;
}

double TrackMeasures::milliseconds_at(double share) const {
  if (milliseconds.empty()) return 0;
  const double place = std::ceil(share * static_cast<double>(milliseconds.size())) - 1;
  return milliseconds[static_cast<std::size_t>(std::max(0.0, place))];
}

Result<TrackReport> evaluate_tracks(const std::vector<io::BopFrame>& frames,
                                    const EvalObjects& objects,
                                    const std::vector<io::TrackResult>& results,
                                    const TrackEvaluationOptions& options) {
  TrackReport report;
  report.options = options;
  if (Status status = validate(report.options); !status.ok()) return status;
  if (Status status = check_truth(frames, objects); !status.ok()) return status;
  const Result<ResultsByFrame> found = by_frame(frames, objects, results);
  if (!found.ok()) return found.status();
  std::map<int, std::vector<const io::BopFrame*>> sequences;
  for (const io::BopFrame& frame : frames) sequences[frame.scene_id].push_back(&frame);
  const SomePoints points = some_points(objects);
  report.total.name = "total";
  for (const auto& [scene_id, of_sequence] : sequences) {
    std::vector<TrackFrame> tracked = truth_of(of_sequence, options);
    std::vector<double> milliseconds;
    std::vector<const io::TrackResult*> given;
    for (const io::BopFrame* frame : of_sequence) {
      const auto at = found->find({frame->scene_id, frame->im_id});
      given.push_back(at != found->end() ? at->second : nullptr);
      if (given.back() != nullptr) milliseconds.push_back(given.back()->milliseconds);
    }
    parallel_for(tracked.size(), options.num_threads, [&](std::size_t i) {
      if (given[i] == nullptr) return;
      add_estimates(*given[i], objects, points, options.match_m, tracked[i]);
    });
    TrackMeasures& sequence = report.sequences.emplace_back(measured(tracked));
    sequence.name = std::to_string(scene_id);
    sequence.milliseconds = std::move(milliseconds);
    std::ranges::sort(sequence.milliseconds);
    add_measures(report.total, sequence);
  }
  std::ranges::sort(report.total.milliseconds);
  return report;
}

}  // namespace bpa::eval
