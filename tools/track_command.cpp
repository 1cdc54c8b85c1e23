// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa track: a sequence of frames in, tracks out, as the server follows them.
#include <algorithm>
#include <cstdio>
#include <optional>

#include "core/base/median.hpp"
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
  double search_ms = 1000, first_budget_ms = 0;
  bool no_poses = false;
  std::string json;
};

/// The search that runs beside the tracker. Its result is there `search_ms` after its frame.
class Searches {
 public:
  Searches(const TrackArguments& arguments, const Detector& detector)
      : a_(arguments), detector_(detector) {}

  void begin_scene() { running_.reset(); }

  /// Hands over a result that is due, and begins the next search, on this frame.
  void after(const Frame& frame, track::Tracker& tracker) {
    if (running_ && frame.stamp_ns < due_ns_) return;
    if (running_) or_throw(tracker.add(*running_));
    DetectRequest request;
    if (!running_) request.budget_ms = a_.first_budget_ms;
    const double takes_ms = request.budget_ms > 0 ? request.budget_ms : a_.search_ms;
    due_ns_ = frame.stamp_ns + static_cast<std::int64_t>(takes_ms * 1e6);
    request.models = a_.detector.models;
    request.seed = a_.common.seed;
    request.num_threads = a_.common.threads;
    request.expected = tracker.expected();
    running_ = or_throw(detector_.detect(frame, request));
  }

 private:
  const TrackArguments& a_;
  const Detector& detector_;
  std::optional<SceneInterpretations> running_;
  std::int64_t due_ns_ = 0;  ///< Stamp of the first frame after its result.
};

void print_frame(const io::TrackResult& frame) {
  for (const EndedTrack& track : frame.ended) {
    std::printf("%d/%d: %s (%llu) ends: %s\n", frame.scene_id, frame.im_id, track.name.c_str(),
                static_cast<unsigned long long>(track.id), track.reason.c_str());
  }
}

void print_scene(const std::vector<io::TrackResult>& results, std::size_t first) {
  std::vector<double> times;
  std::size_t tracks = 0;
  for (std::size_t i = first; i < results.size(); ++i) {
    times.push_back(results[i].milliseconds);
    tracks = std::max(tracks, results[i].tracks.size());
  }
  const double longest = *std::ranges::max_element(times);
  std::printf(
      "scene %d: %zu frames, at most %zu tracks, %.1f ms a frame in the median, %.1f at most\n",
      results[first].scene_id, times.size(), tracks, median(times), longest);
}

void follow_frames(const TrackArguments& a) {
  const auto frames =
      or_throw(io::read_bop_frames(a.dataset.folder, a.dataset.split, a.dataset.scenes));
  const Detector detector = open_detector(a.detector, a.common.threads);
  const auto library = std::make_shared<ModelLibrary>(detector.library());
  track::TrackerOptions options = a.tracker;
  options.num_threads = a.common.threads;
  or_throw(validate(options));
  std::optional<track::Tracker> tracker;
  Searches searches(a, detector);
  std::vector<io::TrackResult> results;
  std::size_t first = 0;
  Progress progress("frames", static_cast<int>(frames.size()));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const io::BopFrame& entry = frames[i];
    progress.show(static_cast<int>(i));
    if (i == 0 || frames[i - 1].scene_id != entry.scene_id) {
      tracker.emplace(library, options, detector.score_layers());
      searches.begin_scene();
      first = results.size();
    }
    const auto frame = std::make_shared<Frame>(or_throw(io::load_bop_frame(entry)));
    frame->frame_id = "camera";
    std::optional<track::CameraPose> camera;
    if (entry.camera_from_world && !a.no_poses)
      camera = {"world", entry.camera_from_world->inverse()};
    io::TrackResult result{or_throw(tracker->track(frame, camera)), entry.scene_id, entry.im_id};
    searches.after(*frame, *tracker);
    progress.clear();
    print_frame(result);
    results.push_back(std::move(result));
    const bool last = i + 1 == frames.size() || frames[i + 1].scene_id != entry.scene_id;
    if (last) print_scene(results, first);
  }
  if (!a.json.empty()) or_throw(io::write_tracks_json(a.json, results));
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
             "then the next begins",
             "T")
      ->check(CLI::PositiveNumber);
  add_option(command, "--first-budget-ms", a.first_budget_ms,
             "Time for the first search of a scene, so that tracks begin early; then the answer "
             "depends on the machine's speed. 0: as the others",
             "T")
      ->check(CLI::NonNegativeNumber);
  command.add_flag("--no-camera-poses", a.no_poses,
                   "Ignore where the data set says that the camera was");
  add_options(command, a.tracker,
              {{"--min-probability", "min_probability"}, {"--lost-s", "lost_s"}});
  add_option(command, "--json", a.json, "Write the tracks of every frame as JSON", "FILE");
}

}  // namespace bpa::cli
