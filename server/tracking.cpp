// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>

#include "core/base/concat.hpp"
#include "core/base/guarded.hpp"

namespace bpa::server {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::duration;
using wire::diagnostic_msgs::KeyValue;

// A camera without frames for so long gives way to another one.
constexpr auto kCameraGone = std::chrono::seconds(2);
// Stamps that go back by more are of a clock that was set anew, as of a recording that repeats.
constexpr std::int64_t kClockRestart_ns = 1'000'000'000;
constexpr auto kRateWindow = std::chrono::seconds(10);
constexpr double kChangedShare = 0.005;     // of the depths of a scene that stands still; by hand
constexpr std::size_t kMaxResults = 16;     // of searches, that wait for the next frame
constexpr std::size_t kMaxTrackName = 100;  // characters of a name that a client gives

double in_ms(Clock::duration time) { return duration<double, std::milli>(time).count(); }

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_name_character(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-' ||
         c == '.';
}

std::string sentence(Unfollowed cause, const Status& why) {
  return concat("frames are not followed (", kUnfollowed[static_cast<std::size_t>(cause)], ")",
                why.message.empty() ? "" : ": ", why.message);
}

void put(std::vector<KeyValue>& values, const std::string& key, std::uint64_t value) {
  values.push_back({key, std::to_string(value)});
}

void put(std::vector<KeyValue>& values, const std::string& what, const Latencies& latencies) {
  if (latencies.empty()) return;
  values.push_back({what + ", median", fixed(latencies.quantile(0.5), 2)});
  values.push_back({what + ", 99 %", fixed(latencies.quantile(0.99), 2)});
}

void put(std::vector<KeyValue>& values, const TfCounts& counts, std::size_t frames) {
  put(values, "frames of /tf", frames);
  put(values, "transforms taken", counts.taken);
  put(values, "transforms refused: numbers or names", counts.bad);
  put(values, "transforms refused: loops", counts.loops);
  put(values, "transforms refused: too many frames", counts.full);
  put(values, "transforms whose stamps went back", counts.restarts);
}

}  // namespace

Tracking::Tracking(std::unique_ptr<ObjectTracker> tracker, const TrackingOptions& options,
                   TrackingLinks links)
    : links_(std::move(links)),
      transforms_(options.tf_buffer_s),
      tracker_(std::move(tracker)),
      options_(options),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Tracking::~Tracking() = default;

/// With mutex_ held.
bool Tracking::is_active() const {
  if (!options_.enabled) return false;
  const auto now = Clock::now();
  if (links_.wanted()) last_wanted_ = now;
  return last_wanted_ && now - *last_wanted_ <= duration<double>(options_.linger_s);
}

bool Tracking::active() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return is_active();
}

void Tracking::push(TrackingFrame frame) {
  TrackingFrame displaced;  // freed outside the lock
  const std::lock_guard<std::mutex> lock(mutex_);
  ++counts_.received;
  if (!frame.frame || !is_active()) {
    ++counts_.unfollowed[static_cast<std::size_t>(Unfollowed::unwanted)];
    return;
  }
  const auto capacity = static_cast<std::size_t>(options_.queue_frames);
  if (queue_.size() >= capacity) {
    auto oldest = std::ranges::find_if(
        queue_, [](const TrackingFrame& waiting) { return !waiting.frame->searched(); });
    // The result of a search is of no use where its frame was not followed: one more may wait.
    if (oldest == queue_.end() && queue_.size() > capacity) oldest = queue_.begin();
    if (oldest != queue_.end()) {
      displaced = std::move(*oldest);
      queue_.erase(oldest);
      ++counts_.unfollowed[static_cast<std::size_t>(Unfollowed::displaced)];
    }
  }
  queue_.push_back(std::move(frame));
  changed_.notify_one();
}

void Tracking::add(const SceneInterpretations& found) {
  const std::lock_guard<std::mutex> tracker_lock(tracker_mutex_);
  const double changed = tracker_->changed_since(found.stamp_ns);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!is_active()) return;
  if (!found.partial) {
    searched_ns_ = found.stamp_ns;
    searched_at_ = Clock::now();
    changed_share_ = changed;
  }
  if (results_.size() >= kMaxResults) results_.erase(results_.begin());
  results_.push_back(found);
}

bool Tracking::rests() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!is_active() || !searched_at_ || changed_share_ > kChangedShare) return false;
  return Clock::now() - *searched_at_ < duration<double>(options_.rest_s);
}

std::optional<std::vector<ExpectedPlacement>> Tracking::expected(
    const std::string& frame_id) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!is_active() || expected_.empty() || frame_id != tracked_camera_) return std::nullopt;
  return expected_;
}

void Tracking::run(const std::stop_token& stop) {
  std::unique_lock<std::mutex> lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return !queue_.empty(); }) && !stop.stop_requested()) {
    const TrackingFrame item = std::move(queue_.front());
    queue_.pop_front();
    working_ = true;
    const std::vector<SceneInterpretations> results = std::exchange(results_, {});
    const TrackingOptions options = options_;
    lock.unlock();
    busy_.begin("the tracking of a frame");
    follow(stop, item, results, options);
    busy_.end();
    lock.lock();
  }
}

void Tracking::follow(const std::stop_token& stop, const TrackingFrame& item,
                      const std::vector<SceneInterpretations>& results,
                      const TrackingOptions& options) {
  std::optional<Refusal> refusal;
  TrackedFrame tracked;
  const Status status = guarded("the tracker failed", [&] {
    refusal = try_follow(stop, item, results, options, tracked);
    if (!refusal) links_.on_tracks(tracked);
  });
  if (!status.ok()) refusal = Refusal{Unfollowed::failed, status};
  if (refusal) {
    note(*refusal);
  } else {
    note(item, tracked);
  }
}

/// Whether the frame is of the camera that is followed, and later than its last one.
std::optional<Tracking::Refusal> Tracking::take_camera(const TrackingFrame& item) {
  if (item.frame_id != camera_ && item.arrived - camera_seen_ <= kCameraGone && !camera_.empty()) {
    return Refusal{Unfollowed::other_camera,
                   Status(StatusCode::busy,
                          concat(item.frame_id, " sends frames, and ", camera_, " is followed"))};
  }
  camera_ = item.frame_id;
  camera_seen_ = item.arrived;
  if (last_stamp_ns_ - item.stamp_ns > kClockRestart_ns) {
    log(links_.log, LogLevel::info,
        concat("stamps of frames went back by ",
               fixed(1e-9 * static_cast<double>(last_stamp_ns_ - item.stamp_ns), 1),
               " s: tracks begin anew"));
    const std::lock_guard<std::mutex> lock(tracker_mutex_);
    tracker_->begin_anew();
    last_stamp_ns_ = 0;
  }
  if (last_stamp_ns_ != 0 && item.stamp_ns <= last_stamp_ns_) {
    return Refusal{Unfollowed::stale, {}};
  }
  return std::nullopt;
}

std::optional<Tracking::Refusal> Tracking::try_follow(
    const std::stop_token& stop, const TrackingFrame& item,
    const std::vector<SceneInterpretations>& results, const TrackingOptions& options,
    TrackedFrame& tracked) {
  if (auto refusal = take_camera(item)) return refusal;
  const ros::DecodedFrame& frame = item.frame->get();
  if (!frame.ok()) return Refusal{Unfollowed::rejected, frame.status()};
  std::optional<track::CameraPose> camera;
  if (!options.fixed_frame.empty()) {
    const auto wait = std::chrono::nanoseconds(static_cast<std::int64_t>(options.tf_wait_ms * 1e6));
    const Result<Pose> pose =
        transforms_.wait_for(options.fixed_frame, item.frame_id, item.stamp_ns, wait, stop);
    if (!pose.ok()) return Refusal{Unfollowed::no_transform, pose.status()};
    camera = track::CameraPose{options.fixed_frame, *pose};
  }
  std::uint64_t untracked = 0;
  const std::lock_guard<std::mutex> lock(tracker_mutex_);
  for (const SceneInterpretations& found : results) {
    if (!tracker_->add(found).ok() && !found.partial) ++untracked;
  }
  Result<TrackedFrame> result =
      tracker_->track(std::shared_ptr<const Frame>(item.frame, &*frame), camera);
  const std::lock_guard<std::mutex> state_lock(mutex_);
  counts_.untracked_searches += untracked;
  tracker_counts_ = tracker_->counts();
  if (!result.ok()) return Refusal{Unfollowed::failed, result.status()};
  tracked = std::move(result).value();
  last_stamp_ns_ = item.stamp_ns;
  changed_share_ = tracker_->changed_since(searched_ns_);
  expected_ = tracker_->expected();
  tracked_camera_ = item.frame_id;
  tracks_.clear();
  for (const Track& track : tracked.tracks) tracks_.emplace_back(track.id, track.name);
  return std::nullopt;
}

void Tracking::note(const TrackingFrame& item, const TrackedFrame& tracked) {
  const auto now = Clock::now();
  const double age_ms = 1e-6 * static_cast<double>(links_.stamp_now() - item.stamp_ns);
  std::unique_lock<std::mutex> lock(mutex_);
  working_ = false;
  ++counts_.followed;
  from_arrival_.add(in_ms(now - item.arrived));
  from_stamp_.add(age_ms);
  working_ms_.add(tracked.milliseconds);
  followed_at_.push_back(now);
  while (now - followed_at_.front() > kRateWindow) followed_at_.pop_front();
  const bool recovered = trouble_.has_value();
  trouble_.reset();
  lock.unlock();
  if (recovered) log(links_.log, LogLevel::info, "frames are followed again");
}

void Tracking::note(const Refusal& refusal) {
  std::unique_lock<std::mutex> lock(mutex_);
  working_ = false;
  ++counts_.unfollowed[static_cast<std::size_t>(refusal.cause)];
  if (refusal.cause == Unfollowed::rejected) return;  // the search says so as well
  const bool known = trouble_ && trouble_->cause == refusal.cause;
  trouble_ = refusal;
  lock.unlock();
  if (!known) log(links_.log, LogLevel::warning, sentence(refusal.cause, refusal.why));
}

Result<std::uint64_t> Tracking::id_of(const std::string& track) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::string there;
  for (const auto& [id, name] : tracks_) {
    if (name == track || std::to_string(id) == track) return id;
    there += concat(there.empty() ? "" : ", ", name, " (", id, ")");
  }
  return not_found("there is no track \"", track.substr(0, kMaxTrackName),
                   "\"; there are: ", there.empty() ? "none" : there);
}

Status Tracking::check_name(const std::string& name) const {
  if (name.empty() || name.size() > kMaxTrackName ||
      !std::ranges::all_of(name, is_name_character) || std::ranges::all_of(name, is_digit)) {
    return invalid_argument("name must have 1 to ", kMaxTrackName,
                            " letters, digits, '_', '-' and '.', and not digits alone");
  }
  if (transforms_.knows(name)) {
    return invalid_argument("name is \"", name, "\", which is a frame of /tf already");
  }
  return {};
}

Result<std::uint64_t> Tracking::rename(const std::string& track, const std::string& name) {
  if (Status status = check_name(name); !status.ok()) return status;
  const std::lock_guard<std::mutex> lock(tracker_mutex_);
  const Result<std::uint64_t> id = id_of(track);
  if (!id.ok()) return id;
  if (Status status = tracker_->rename(*id, name); !status.ok()) return status;
  const std::lock_guard<std::mutex> state_lock(mutex_);
  for (auto& [known, old_name] : tracks_) {
    if (known == *id) old_name = name;
  }
  return id;
}

Result<std::uint64_t> Tracking::hold(const std::string& track, bool held) {
  const std::lock_guard<std::mutex> lock(tracker_mutex_);
  const Result<std::uint64_t> id = id_of(track);
  if (!id.ok()) return id;
  if (Status status = tracker_->hold(*id, held); !status.ok()) return status;
  return id;
}

Result<std::uint64_t> Tracking::forget(const std::string& track) {
  const std::lock_guard<std::mutex> lock(tracker_mutex_);
  const Result<std::uint64_t> id = id_of(track);
  if (!id.ok()) return id;
  if (Status status = tracker_->forget(*id); !status.ok()) return status;
  return id;
}

void Tracking::set_options(const TrackingOptions& options) {
  transforms_.set_keep(options.tf_buffer_s);
  const std::lock_guard<std::mutex> lock(tracker_mutex_);
  tracker_->set_options(options);
  const std::lock_guard<std::mutex> state_lock(mutex_);
  options_ = options;
}

TrackingCounts Tracking::counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  TrackingCounts counts = counts_;
  counts.waiting = queue_.size() + (working_ ? 1 : 0);
  return counts;
}

SourceReport Tracking::report() const {
  const TrackingCounts counts = this->counts();
  SourceReport report;
  report.name = "tracking";
  auto& values = report.values;
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto now = Clock::now();
  const auto recent = std::ranges::count_if(
      followed_at_, [&](const auto& time) { return now - time <= kRateWindow; });
  const double rate = static_cast<double>(recent) / duration<double>(kRateWindow).count();
  const bool active = is_active();
  if (!options_.enabled) {
    report.message = "off (tracking.enabled)";
  } else if (!active) {
    report.message = "no topic of tracks has a subscriber";
  } else if (trouble_) {
    report.level = SourceReport::kWarn;
    report.message = sentence(trouble_->cause, trouble_->why);
  } else {
    report.message = concat(tracks_.size(), " tracks");
  }
  values.push_back({"frames followed per s", fixed(rate, 2)});
  put(values, "frames to follow received", counts.received);
  put(values, "frames followed", counts.followed);
  for (std::size_t i = 0; i < counts.unfollowed.size(); ++i) {
    put(values, concat("frames not followed: ", kUnfollowed[i]), counts.unfollowed[i]);
  }
  put(values, "ms from a frame's arrival to its tracks", from_arrival_);
  put(values, "ms from a frame's stamp to its tracks", from_stamp_);
  put(values, "ms of the tracker", working_ms_);
  put(values, "tracks", tracks_.size());
  put(values, "tracks begun", tracker_counts_.births);
  put(values, "tracks confirmed", tracker_counts_.confirmed);
  put(values, "tracks lost", tracker_counts_.losses);
  put(values, "tracks found again", tracker_counts_.found_again);
  put(values, "tracks ended", tracker_counts_.ends);
  put(values, "searches taken by tracking", tracker_counts_.searches);
  put(values, "searches of frames that were not followed", counts.untracked_searches);
  if (!options_.fixed_frame.empty()) {
    put(values, transforms_.counts(), transforms_.frames());
  }
  return report;
}

}  // namespace bpa::server
