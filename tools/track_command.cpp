// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa track: a sequence of frames in, tracks out, as the server follows them.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/concat.hpp"
#include "core/base/median.hpp"
#include "core/io/results.hpp"
#include "core/io/tracks.hpp"
#include "core/track/tracker.hpp"
#include "tools/search.hpp"

namespace bpa::cli {
namespace {

struct TrackArguments {
  CommonOptions common;
  DetectorArguments detector;
  DatasetOptions dataset;
  track::TrackerOptions tracker;
  double search_ms = 1000;
  bool no_poses = false;
  std::string json, detections;
};

/// The search that runs beside the tracker. Its result is there `search_ms` after its frame, what
/// each of its rounds has found after an equal share of that.
class Searches {
 public:
  Searches(const TrackArguments& arguments, const Detector& detector)
      : a_(arguments), detector_(detector) {}

  /// Hands over results that are due. Once all are, begins the next search, on this frame.
  void after(const Frame& frame, const Pose& camera, track::Tracker& tracker) {
    const double passed_ms = 1e-6 * static_cast<double>(frame.stamp_ns - began_ns_);
    while (!found_.empty() && passed_ms >= share_ms_ * static_cast<double>(handed_over_ + 1)) {
      or_throw(tracker.add(found_.front()));
      if (!found_.front().partial && !found_.front().interpretations.empty()) {
        newest_ = std::move(found_.front());
        newest_camera_ = camera_;
      }
      found_.pop_front();
      ++handed_over_;
    }
    if (!found_.empty()) return;
    camera_ = camera;
    search(frame, tracker);
  }

  /// What a user of detections alone has in a frame: the placements of the newest result that is
  /// there, moved as the camera since.
  io::FrameResult held(const io::TrackResult& now) const {
    io::FrameResult result;
    result.scene_id = now.scene_id;
    result.im_id = now.im_id;
    result.stamp_ns = now.stamp_ns;
    if (!newest_) return result;
    result.interpretations = {newest_->interpretations.front()};
    const Pose now_from_then = now.frame_from_camera.inverse() * newest_camera_;
    for (Placement& placement : result.interpretations.front().placements) {
      placement.frame_from_object = now_from_then * placement.frame_from_object;
    }
    return result;
  }

 private:
  void search(const Frame& frame, const track::Tracker& tracker) {
    DetectRequest request = request_of(a_.common);
    request.models = a_.detector.models;
    request.expected = tracker.expected();
    request.on_round = [&](const SceneInterpretations& part) { found_.push_back(part); };
    SceneInterpretations whole = or_throw(detector_.detect(frame, request));
    if (!found_.empty()) found_.pop_back();  // the last round's: the whole comes with it
    found_.push_back(std::move(whole));
    began_ns_ = frame.stamp_ns;
    share_ms_ = a_.search_ms / static_cast<double>(found_.size());
    handed_over_ = 0;
  }

  const TrackArguments& a_;
  const Detector& detector_;
  std::deque<SceneInterpretations> found_;  ///< Of the search that runs, in their order.
  std::int64_t began_ns_ = 0;               ///< Stamp of its frame.
  double share_ms_ = 0;                     ///< Between its results.
  int handed_over_ = 0;
  Pose camera_;                                 ///< Where it was in that frame.
  std::optional<SceneInterpretations> newest_;  ///< That is there.
  Pose newest_camera_;
};

void print_frame(const io::TrackResult& frame) {
  for (const EndedTrack& track : frame.ended) {
    std::printf("%d/%d: %s (%llu) ends: %s\n", frame.scene_id, frame.im_id, track.name.c_str(),
                static_cast<unsigned long long>(track.id), track.reason.c_str());
  }
}

void print_scene(std::span<const io::TrackResult> results) {
  if (results.empty()) return;
  std::vector<double> times;
  std::size_t tracks = 0;
  for (const io::TrackResult& result : results) {
    times.push_back(result.milliseconds);
    tracks = std::max(tracks, result.tracks.size());
  }
  const double longest = *std::ranges::max_element(times);
  std::printf(
      "scene %d: %zu frames, at most %zu tracks, %.1f ms a frame in the median, %.1f at most\n",
      results.front().scene_id, times.size(), tracks, median(times), longest);
}

/// The frames of one scene. Returns how many could not be followed.
int follow_scene(const TrackArguments& a, const Detector& detector, track::Tracker& tracker,
                 std::span<const io::BopFrame> frames, std::vector<io::TrackResult>& results,
                 std::vector<io::FrameResult>& detections) {
  Searches searches(a, detector);
  int failed = 0;
  Progress progress(concat("scene ", frames.front().scene_id), static_cast<int>(frames.size()));
  const std::size_t first = results.size();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const io::BopFrame& entry = frames[i];
    progress.show(static_cast<int>(i));
    Result<Frame> loaded = io::load_bop_frame(entry);
    const auto frame = std::make_shared<Frame>(loaded.ok() ? *std::move(loaded) : Frame());
    frame->frame_id = "camera";
    std::optional<track::CameraPose> camera;
    if (entry.camera_from_world && !a.no_poses)
      camera = {"world", entry.camera_from_world->inverse()};
    Result<TrackedFrame> tracked =
        loaded.ok() ? tracker.track(frame, camera) : Result<TrackedFrame>(loaded.status());
    progress.clear();
    if (!tracked.ok()) {
      ++failed;
      std::fprintf(stderr, "warning: %d/%d is not followed: %s\n", entry.scene_id, entry.im_id,
                   tracked.status().message.c_str());
      continue;
    }
    results.push_back({*std::move(tracked), entry.scene_id, entry.im_id});
    print_frame(results.back());
    searches.after(*frame, results.back().frame_from_camera, tracker);
    detections.push_back(searches.held(results.back()));
  }
  print_scene(std::span(results).subspan(first));
  return failed;
}

void follow_frames(const TrackArguments& a) {
  auto frames = or_throw(io::read_bop_frames(a.dataset.folder, a.dataset.split, a.dataset.scenes));
  const Detector detector = open_detector(a.detector, a.common.threads);
  number_truth(a.dataset.folder, detector.library(), a.detector.models.empty(), frames);
  const auto library = std::make_shared<ModelLibrary>(detector.library());
  track::TrackerOptions options = a.tracker;
  options.num_threads = a.common.threads;
  or_throw(validate(options));
  std::vector<io::TrackResult> results;
  std::vector<io::FrameResult> detections;
  int failed = 0;
  for (auto first = frames.begin(); first != frames.end();) {
    const auto last = std::find_if(first, frames.end(), [&](const io::BopFrame& frame) {
      return frame.scene_id != first->scene_id;
    });
    track::Tracker tracker(library, options, detector.score_layers());
    failed += follow_scene(a, detector, tracker, {first, last}, results, detections);
    first = last;
  }
  if (!a.json.empty()) or_throw(io::write_tracks_json(a.json, results));
  if (!a.detections.empty()) or_throw(io::write_results_json(a.detections, detections));
  if (failed == 0) return;
  throw Failure(invalid_argument(failed, " of ", frames.size(), " frames could not be followed"));
}

}  // namespace

void add_track_command(CLI::App& program) {
  const auto [command, a] = add_command(
      program, "track", "Follow objects through sequences of RGB-D frames", follow_frames);
  add_detector_options(command, a.detector);
  add_dataset_options(command, a.dataset);
  add_option(command, "--models", a.detector.models,
             "Names of models to look for; all if not given", "LIST")
      ->delimiter(',');
  add_option(command, "--search-ms", a.search_ms,
             "A search beside the tracks gives its result this long after its frame, by stamps; "
             "what its rounds have found comes before, evenly spread. Then the next begins",
             "T")
      ->check(CLI::PositiveNumber);
  command.add_flag("--no-camera-poses", a.no_poses,
                   "Ignore where the data set says that the camera was");
  add_options(command, options_of(a.tracker),
              {{"--min-probability", "min_probability"}, {"--lost-s", "lost_s"}});
  add_option(command, "--json", a.json, "Write the tracks of every frame as JSON", "FILE");
  add_option(
      command, "--detections", a.detections,
      "Write what the same searches show without tracks, to compare with (evaluate --tracks): "
      "in every frame the newest result that is there, moved as the camera since",
      "FILE");
}

}  // namespace bpa::cli
