// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/library_tracker.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace bpa::server {
namespace {

std::shared_ptr<const ModelLibrary> library_of(std::shared_ptr<const Detector> detector) {
  const ModelLibrary* library = &detector->library();
  return {std::move(detector), library};
}

track::TrackerCounts operator+(track::TrackerCounts sum, const track::TrackerCounts& more) {
  for (const auto count :
       {&track::TrackerCounts::frames, &track::TrackerCounts::births,
        &track::TrackerCounts::confirmed, &track::TrackerCounts::losses,
        &track::TrackerCounts::found_again, &track::TrackerCounts::ends,
        &track::TrackerCounts::searches, &track::TrackerCounts::stale_searches}) {
    sum.*count += more.*count;
  }
  return sum;
}

class LibraryTracker : public ObjectTracker {
 public:
  LibraryTracker(std::function<std::shared_ptr<const Detector>()> current, ScoreLayers layers,
                 const track::TrackerOptions& options)
      : current_(std::move(current)),
        layers_(std::move(layers)),
        options_(options),
        detector_(current_()) {
    tracker_.emplace(library_of(detector_), options_, layers_);
  }

  Result<TrackedFrame> track(std::shared_ptr<const Frame> frame,
                             const std::optional<track::CameraPose>& camera) override {
    if (auto detector = current_(); detector != detector_) {
      detector_ = std::move(detector);
      tracker_->set_library(library_of(detector_), layers_);
    }
    Result<TrackedFrame> tracked = tracker_->track(std::move(frame), camera);
    if (!tracked.ok()) return tracked;
    last_ = *tracked;
    for (Track& track : tracked->tracks) track.id += earlier_ids_;
    for (EndedTrack& track : tracked->ended) track.id += earlier_ids_;
    for (const Track& track : tracked->tracks) largest_id_ = std::max(largest_id_, track.id);
    for (const EndedTrack& track : tracked->ended) largest_id_ = std::max(largest_id_, track.id);
    tracked->ended.insert(tracked->ended.begin(), ended_.begin(), ended_.end());
    ended_.clear();
    return tracked;
  }

  /// A new tracker, which counts its ids from 1: ours go on.
  void begin_anew() override {
    for (const Track& track : last_.tracks) {
      ended_.push_back({track.id + earlier_ids_, track.name, "the stamps of frames went back"});
    }
    earlier_counts_ = counts();
    earlier_counts_.ends += last_.tracks.size();
    earlier_ids_ = largest_id_;
    last_ = {};
    tracker_.emplace(library_of(detector_), options_, layers_);
  }

  Status add(const SceneInterpretations& found) override { return tracker_->add(found); }
  double changed_since(std::int64_t stamp_ns) const override {
    return tracker_->changed_since(stamp_ns);
  }
  std::vector<ExpectedPlacement> expected() const override { return tracker_->expected(); }
  Status rename(std::uint64_t id, const std::string& name) override {
    return tracker_->rename(id - earlier_ids_, name);
  }
  Status hold(std::uint64_t id, bool held) override {
    return tracker_->hold(id - earlier_ids_, held);
  }
  Status forget(std::uint64_t id) override { return tracker_->forget(id - earlier_ids_); }
  void set_options(const track::TrackerOptions& options) override {
    options_ = options;
    tracker_->set_options(options);
  }
  track::TrackerCounts counts() const override { return earlier_counts_ + tracker_->counts(); }

 private:
  const std::function<std::shared_ptr<const Detector>()> current_;
  const ScoreLayers layers_;
  track::TrackerOptions options_;
  std::shared_ptr<const Detector> detector_;
  std::optional<track::Tracker> tracker_;
  std::uint64_t earlier_ids_ = 0;  ///< The largest id of trackers before this one.
  std::uint64_t largest_id_ = 0;
  track::TrackerCounts earlier_counts_;
  TrackedFrame last_;              ///< With the tracker's own ids.
  std::vector<EndedTrack> ended_;  ///< With the trackers before this one; for the next frame.
};

}  // namespace

std::unique_ptr<ObjectTracker> make_library_tracker(
    std::function<std::shared_ptr<const Detector>()> current, ScoreLayers layers,
    const track::TrackerOptions& options) {
  return std::make_unique<LibraryTracker>(std::move(current), std::move(layers), options);
}

}  // namespace bpa::server
