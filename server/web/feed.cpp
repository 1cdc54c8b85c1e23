// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/feed.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "core/base/concat.hpp"
#include "core/io/tracks.hpp"
#include "server/web/json_text.hpp"

namespace bpa::server::web {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxViewers = 16;
constexpr std::size_t kMaxViewerName = 40;
/// Pictures of a frame are asked for once it is known, when a newer one may have come.
constexpr std::size_t kKeptFrames = 3;
/// Of the frames of all results that are kept. A frame of 640 x 480 has 2.1 MB.
constexpr std::size_t kMaxKeptBytes = std::size_t{256} << 20U;

std::size_t bytes_of(const Frame& frame) {
  return frame.depth.size() * sizeof(float) + frame.color.size() + frame.mask.size();
}

bool within_patience(Feed::Clock::rep seen) {
  if (seen == 0) return false;
  return Feed::Clock::now() - Feed::Clock::time_point(Feed::Clock::duration(seen)) <
         Feed::kViewerPatience;
}

std::string json_of(const KeptResult& kept) {
  const Camera& camera = kept.camera;
  const Json about = {{"id", kept.id},
                      {"origin", kept.origin},
                      {"advice", kept.advice},
                      {"came_ns", kept.came_ns},
                      {"camera",
                       {{"width", camera.width},
                        {"height", camera.height},
                        {"fx", camera.fx},
                        {"fy", camera.fy},
                        {"cx", camera.cx},
                        {"cy", camera.cy}}}};
  std::string text = json_text(about);
  text.pop_back();
  return text + ",\"total_ms\":" + fixed(kept.result.total_milliseconds, 3) +
         ",\"result\":" + io::result_json_line(kept.result) + "}";
}

}  // namespace

const std::string& KeptResult::json() const {
  std::call_once(json_made_, [this] { json_ = json_of(*this); });
  return json_;
}

std::string KeptResult::summary() const {
  Json stages = Json::array();
  for (const StageTiming& timing : result.timings) {
    stages.push_back({timing.stage, timing.milliseconds});
  }
  const auto& found = result.interpretations;
  Json objects = Json::array();
  if (!found.empty()) {
    for (const Placement& placement : found[0].placements) {
      objects.push_back({placement.model, placement.presence});
    }
  }
  return json_text({{"id", id},
                    {"origin", origin},
                    {"stamp_ns", result.stamp_ns},
                    {"came_ns", came_ns},
                    {"total_ms", result.total_milliseconds},
                    {"interpretations", found.size()},
                    {"objects", objects},
                    {"stages", stages}});
}

bool Feed::wanted() const { return within_patience(last_seen_); }
bool Feed::tracks_wanted() const { return within_patience(last_saw_tracks_); }

void Feed::changed() {
  ++sequence_;
  const std::lock_guard<std::mutex> lock(change_mutex_);
  if (on_change_) on_change_();
}

void Feed::on_change(std::function<void()> changed) {
  const std::lock_guard<std::mutex> lock(change_mutex_);
  on_change_ = std::move(changed);
}

void Feed::add_frame(std::shared_ptr<SharedFrame> frame, std::int64_t stamp_ns,
                     const std::string& frame_id) {
  if (!wanted()) return;
  auto shown = std::make_shared<ShownFrame>([frame]() -> std::shared_ptr<const Frame> {
    const ros::DecodedFrame& decoded = frame->get();
    return decoded.ok() ? std::shared_ptr<const Frame>(frame, &*decoded) : nullptr;
  });
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!std::exchange(frame_seen_, false)) ++frames_unseen_;
    frames_.push_back({next_frame_++, stamp_ns, now_ns_(), frame_id, std::move(shown)});
    if (frames_.size() > kKeptFrames) frames_.pop_front();
  }
  changed();
}

void Feed::keep(std::shared_ptr<KeptResult> kept) {
  const std::lock_guard<std::mutex> lock(mutex_);
  kept->id = next_result_++;
  kept->came_ns = now_ns_();
  results_.push_back(std::move(kept));
  std::size_t bytes = 0, count = 0;
  for (auto result = results_.rbegin(); result != results_.rend(); ++result, ++count) {
    bytes += bytes_of(*(*result)->shown->frame());
    if (count > 0 && (count >= history_ || bytes > kMaxKeptBytes)) break;
  }
  const auto kept_from = results_.end() - static_cast<std::ptrdiff_t>(count);
  const auto held = [this](const auto& result) {
    return std::ranges::any_of(viewers_, [id = result->id](const auto& viewer) {
      return viewer.second.held == id || viewer.second.told == id;
    });
  };
  results_.erase(std::remove_if(results_.begin(), kept_from, std::not_fn(held)), kept_from);
}

std::uint64_t Feed::add(const Frame& frame, const SceneInterpretations& result, std::string origin,
                        const std::string& advice) {
  auto kept = std::make_shared<KeptResult>();
  kept->origin = std::move(origin);
  kept->advice = advice;
  kept->camera = frame.camera;
  kept->shown =
      std::make_shared<ShownFrame>([copy = std::make_shared<const Frame>(frame)] { return copy; });
  static_cast<SceneInterpretations&>(kept->result) = result;
  kept->result.seconds = 0.001 * result.total_milliseconds;
  kept->result.server.emplace();  // so that the stamp is written
  keep(kept);
  changed();
  return kept->id;
}

void Feed::add_result(const Frame& frame, const SceneInterpretations& result,
                      const std::string& advice) {
  if (wanted()) add(frame, result, "camera", advice);
}

std::uint64_t Feed::add_asked(const Frame& frame, const SceneInterpretations& result,
                              std::string origin, const std::string& advice) {
  last_seen_ = Clock::now().time_since_epoch().count();
  return add(frame, result, std::move(origin), advice);
}

void Feed::add_tracks(const TrackedFrame& tracks) {
  if (!wanted()) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    tracks_ = tracks;
  }
  changed();
}

Status Feed::see(const std::string& viewer, bool tracks, std::uint64_t held) {
  if (viewer.empty() || viewer.size() > kMaxViewerName) {
    return invalid_argument("viewer must have 1 to ", kMaxViewerName, " characters");
  }
  const Clock::time_point now = Clock::now();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!viewers_.contains(viewer) && viewers_.size() >= kMaxViewers) {
    return Status(StatusCode::busy,
                  concat(viewers_.size(), " viewers look, as many as may; try again later"));
  }
  Viewer& seen = viewers_[viewer];
  seen.seen = now;
  seen.held = held;
  last_seen_ = now.time_since_epoch().count();
  if (tracks) last_saw_tracks_ = last_seen_.load();
  return {};
}

void Feed::tidy() {
  std::deque<std::shared_ptr<const KeptResult>> results;  // freed outside of the lock
  std::deque<CameraFrame> frames;
  const std::lock_guard<std::mutex> lock(mutex_);
  viewers_gone_ += std::erase_if(viewers_, [now = Clock::now()](const auto& viewer) {
    return now - viewer.second.seen >= kViewerPatience;
  });
  if (!viewers_.empty() || wanted()) return;
  results.swap(results_);
  frames.swap(frames_);
  tracks_.reset();
  frame_seen_ = true;
}

std::optional<CameraFrame> Feed::camera_frame() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (frames_.empty()) return std::nullopt;
  frame_seen_ = true;
  return frames_.back();
}

std::optional<CameraFrame> Feed::camera_frame(std::uint64_t id) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found =
      std::ranges::find_if(frames_, [id](const CameraFrame& frame) { return frame.id >= id; });
  if (found == frames_.end()) return std::nullopt;
  return *found;
}

std::vector<std::shared_ptr<const KeptResult>> Feed::results_after(std::uint64_t id) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto first =
      std::ranges::find_if(results_, [id](const auto& result) { return result->id > id; });
  return {first, results_.end()};
}

std::vector<std::shared_ptr<const KeptResult>> Feed::tell(const std::string& viewer,
                                                          std::uint64_t id) {
  auto results = results_after(id);
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto told = viewers_.find(viewer);
  if (told != viewers_.end() && !results.empty()) told->second.told = results.back()->id;
  return results;
}

std::shared_ptr<const KeptResult> Feed::result(std::uint64_t id) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = std::ranges::find(results_, id, &KeptResult::id);
  return found == results_.end() ? nullptr : *found;
}

std::string Feed::tracks() const {
  io::TrackResult tracks;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!tracks_) return "";
    static_cast<TrackedFrame&>(tracks) = *tracks_;
  }
  return io::track_json_line(tracks);
}

FeedCounts Feed::counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return {viewers_.size(), viewers_gone_, frames_unseen_};
}

}  // namespace bpa::server::web
