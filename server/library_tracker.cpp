// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/library_tracker.hpp"

#include <utility>

namespace bpa::server {
namespace {

std::shared_ptr<const ModelLibrary> library_of(std::shared_ptr<const Detector> detector) {
  const ModelLibrary* library = &detector->library();
  return {std::move(detector), library};
}

class LibraryTracker : public ObjectTracker {
 public:
  LibraryTracker(std::function<std::shared_ptr<const Detector>()> current,
                 score::ScoreLayers layers, const track::TrackerOptions& options)
      : current_(std::move(current)),
        layers_(std::move(layers)),
        detector_(current_()),
        tracker_(library_of(detector_), options, layers_) {}

  Result<TrackedFrame> track(std::shared_ptr<const Frame> frame,
                             const std::optional<track::CameraPose>& camera) override {
    if (auto detector = current_(); detector != detector_) {
      detector_ = std::move(detector);
      tracker_.set_library(library_of(detector_), layers_);
    }
    return tracker_.track(std::move(frame), camera);
  }
  void begin_anew() override { tracker_.begin_anew("the stamps of frames went back"); }
  Status add(const SceneInterpretations& found) override { return tracker_.add(found); }
  double changed_since(std::int64_t stamp_ns) const override {
    return tracker_.changed_since(stamp_ns);
  }
  std::vector<ExpectedPlacement> expected() const override { return tracker_.expected(); }
  Status rename(std::uint64_t id, const std::string& name) override {
    return tracker_.rename(id, name);
  }
  Status hold(std::uint64_t id, bool held) override { return tracker_.hold(id, held); }
  Status forget(std::uint64_t id) override { return tracker_.forget(id); }
  void set_options(const track::TrackerOptions& options) override { tracker_.set_options(options); }
  track::TrackerCounts counts() const override { return tracker_.counts(); }

 private:
  const std::function<std::shared_ptr<const Detector>()> current_;
  const score::ScoreLayers layers_;
  std::shared_ptr<const Detector> detector_;
  track::Tracker tracker_;
};

}  // namespace

std::unique_ptr<ObjectTracker> make_library_tracker(
    std::function<std::shared_ptr<const Detector>()> current, score::ScoreLayers layers,
    const track::TrackerOptions& options) {
  return std::make_unique<LibraryTracker>(std::move(current), std::move(layers), options);
}

}  // namespace bpa::server
