// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/server.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <unistd.h>

#include "core/base/clock.hpp"
#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "core/base/guarded.hpp"
#include "core/io/camera_poses_file.hpp"
#include "idl/wire/participant.hpp"
#include "server/advice.hpp"
#include "server/busy.hpp"
#include "server/diagnostics.hpp"
#include "server/log_relay.hpp"
#include "server/output.hpp"
#include "server/parameters.hpp"
#include "server/participant_options.hpp"
#include "server/result_publisher.hpp"
#include "server/ros_clock.hpp"
#include "server/search_queue.hpp"
#include "server/services/services.hpp"
#include "server/settings.hpp"
#include "server/sources/frame_source.hpp"
#include "server/sources/transform_source.hpp"
#include "server/statistics.hpp"
#include "server/track_publisher.hpp"
#include "server/tracking.hpp"
#include "server/view_gate.hpp"
#include "server/web/feed.hpp"
#include "server/web/page.hpp"
#include "server/web/recent_log.hpp"

#ifndef BPA_VERSION
#define BPA_VERSION "0"
#endif

namespace bpa::server {
namespace {

namespace msgs = wire::bpa_msgs;
using Clock = std::chrono::steady_clock;
using wire::diagnostic_msgs::KeyValue;

constexpr auto kReportPeriod = std::chrono::seconds(1);
constexpr auto kRepeatAfter = std::chrono::seconds(10);

/// Frames that are to be combined must be able to wait for one another.
int frame_capacity(const ServerOptions& options) {
  return std::max(options.queue.frames, options.detection.fuse_frames);
}

SearchQueueOptions search_options(const ServerOptions& options) {
  const DetectionOptions& detection = options.detection;
  return {.frame_capacity = static_cast<std::size_t>(frame_capacity(options)),
          .request_capacity = static_cast<std::size_t>(options.queue.requests),
          .continuous = detection.continuous,
          .fuse_frames = detection.fuse_frames,
          .follow = detection.follow,
          .request = {.top_k = detection.top_k,
                      .budget_ms = detection.budget_ms,
                      .seed = detection.seed,
                      .num_threads = detection.threads}};
}

/// Resident memory of this process in bytes; 0 when unknown.
std::uint64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t total = 0, resident = 0;
  file >> total >> resident;
  return file ? resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) : 0;
}

class Running : public Server {
 public:
  Running(const ServerOptions& options, std::shared_ptr<Recognition> recognition, LogHook log)
      : settings_(options),
        recognition_(std::move(recognition)),
        terminal_(std::move(log)),
        relay_(options.web.listen.empty() ? terminal_ : recent_log_.before(terminal_),
               log_level(options.log.level)),
        log_(relay_.hook()),
        statistics_(clock_),
        feed_(static_cast<std::size_t>(options.web.history),
              [clock = clock_] { return clock->stamp_ns(); }) {}

  ~Running() override {
    if (queue_) queue_->stop();  // answers what waits, while the services can still send it
    const std::lock_guard<std::shared_mutex> lock(leaving_mutex_);
    ready_ = false;
    open_page_ = nullptr;
    recognition_->leave_group();
  }

  /// Throws a Failure.
  void start() {
    const ServerOptions options = *settings_.get();
    join(options);
    or_throw(clock_->simulate(*participant_, options.node.use_sim_time));
    publisher_ =
        std::make_unique<ResultPublisher>(*participant_, settings_, recognition_, clock_, log_);
    publisher_->publish_vision_info();
    diagnostics_.open(*participant_, options.output.diagnostics, wire::qos::results());

    if (options.group.role == "front") {
      recognition_->join_group(*participant_, options.group, log_);
    }
    start_tracking(options);
    queue_ = std::make_unique<SearchQueue>(
        recognition_, queue_options(options), statistics_,
        [this](const IncomingFrame& incoming, const Frame* frame,
               const Result<SceneInterpretations>& result) { on_result(incoming, frame, result); },
        log_, steady_clock(), clock_);
    start_sources(options);
    offer_services();
    settings_.on_change([this](const ServerOptions& before, const ServerOptions& after) {
      return apply(before, after);
    });
    parameters_.emplace(*participant_, log_, wire::qos::parameters());
    setter_ = std::make_shared<ParameterSetter>(*participant_, settings_, clock_);
    add_parameter_services(settings_, setter_, *parameters_);
    add_type_description_service(*parameters_);
    ready_ = true;
    if (!options.web.listen.empty()) open_page(options.web);
    reporter_ = std::jthread([this](const std::stop_token& stop) { report(stop); });
  }

  Status health() const override {
    const double limit = settings_.get()->detection.hang_s;
    if (limit == 0) return {};
    const std::shared_lock<std::shared_mutex> lock(leaving_mutex_);
    for (const Busy* busy : threads()) {
      const std::optional<Busy::Work> work = busy->work();
      if (!work || work->seconds <= limit) continue;
      return Status(StatusCode::internal,
                    concat(work->name, " has not returned for ", fixed(work->seconds, 1),
                           " s (detection.hang_s is ", limit, "): it hangs"));
    }
    return {};
  }

  void leave_to_another() override { queue_->leave_to_another(); }

  void abandon(const Status& why) override {
    log(log_, LogLevel::error, why.message + "; the server ends");
    queue_->abandon(why);
    {
      const std::lock_guard<std::shared_mutex> lock(leaving_mutex_);
      ready_ = false;
    }
    services_.reset();
    parameters_.reset();
    reporter_.request_stop();
    reporter_.join();
    report_once();
    std::shared_ptr<FrameSource> camera;  // ends when the lock is free
    const std::lock_guard<std::shared_mutex> lock(leaving_mutex_);
    if (sources_.size() > 1) camera.swap(sources_.back());
    sources_.resize(1);
  }

 private:
  /// What each thread that must not hang does now. The caller holds leaving_mutex_.
  std::vector<const Busy*> threads() const {
    std::vector<const Busy*> threads = queue_->threads();
    threads.insert(threads.end(), {&tracking_->busy(), &reporting_});
    if (ready_) threads.insert(threads.end(), {&services_->busy(), &parameters_->busy()});
    if (web::Page* page = open_page_) threads.push_back(&page->busy());
    for (const auto& source : sources_) {
      for (const Busy* busy : source->threads()) threads.push_back(busy);
    }
    return threads;
  }

  void join(const ServerOptions& options) {
    participant_.emplace(or_throw(wire::Participant::create(participant_options(options, log_))));
    if (const std::string& folder = participant_->enclave_folder(); !folder.empty()) {
      log(log_, LogLevel::info, "only peers of its keystore take part, by the keys in " + folder);
    }
    const std::string& rosout = options.output.rosout;
    if (!rosout.empty()) relay_.connect(*participant_, rosout);
  }

  void start_tracking(const ServerOptions& options) {
    track_publisher_ =
        std::make_unique<TrackPublisher>(*participant_, settings_, recognition_, log_);
    tracking_ = std::make_unique<Tracking>(
        recognition_->make_tracker(options.tracking), options.tracking,
        TrackingLinks{[this] { return track_publisher_->wanted() || feed_.tracks_wanted(); },
                      [this](const TrackedFrame& frame) {
                        track_publisher_->publish(frame);
                        feed_.add_tracks(frame);
                      },
                      [this] { return clock_->stamp_ns(); }, log_});
    if (options.tracking.fixed_frame.empty()) return;
    transforms_.emplace(*participant_, options.input.tf, options.input.tf_static,
                        tracking_->transforms());
  }

  SearchQueueOptions queue_options(const ServerOptions& options) const {
    SearchQueueOptions queue = search_options(options);
    queue.camera = [this](const std::string& frame_id, std::int64_t stamp_ns) {
      return camera_at(settings_.get()->tracking.fixed_frame, frame_id, stamp_ns);
    };
    queue.expected = [this](const std::string& frame_id) { return tracking_->expected(frame_id); };
    queue.tracked = [this] { return tracking_->active(); };
    queue.on_round = [this](const SceneInterpretations& found) { tracking_->add(found); };
    queue.added_nice = options.tracking.search_nice;
    return queue;
  }

  /// Hands a frame to the search and to the tracker. The search first: what it displaces there may
  /// be displaced here, too.
  void take(IncomingFrame&& incoming) {
    TrackingFrame tracked{nullptr, incoming.stamp_ns, incoming.frame_id, Clock::now()};
    if (tracking_->active() || feed_.wanted()) {
      tracked.frame = std::make_shared<SharedFrame>(std::move(incoming.decode));
      incoming.decode = [shared = tracked.frame] { return shared->get(); };
      incoming.taken = [shared = tracked.frame] { shared->set_searched(); };
      feed_.add_frame(tracked.frame, incoming.stamp_ns, incoming.frame_id);
    }
    if (gate_ && gate_->takes(incoming.frame_id)) {
      take_view(std::move(incoming));
    } else if (!publisher_->wanted() && !feed_.wanted() && tracking_->rests()) {
      statistics_.add_frame(clock_->stamp_ns() - incoming.stamp_ns);
      statistics_.add(&Counts::frames_dropped);
      statistics_.add(&Counts::frames_at_rest);
    } else {
      queue_->push(std::move(incoming));
    }
    tracking_->push(std::move(tracked));
  }

  /// fixed_from_camera by the settings, else by TF, for which it waits.
  Result<Pose> camera_at(const std::string& fixed_frame, const std::string& frame_id,
                         std::int64_t stamp_ns) const {
    const Settings::Snapshot now = settings_.get();
    const auto known = camera_poses_.find(frame_id);
    const bool in_settings = known != camera_poses_.end();
    if (in_settings && fixed_frame == now->tracking.fixed_frame) return known->second;
    const auto patience = std::chrono::duration<double, std::milli>(now->tracking.tf_wait_ms);
    return tracking_->transforms().wait_for(
        fixed_frame, frame_id, stamp_ns,
        std::chrono::duration_cast<std::chrono::nanoseconds>(patience), std::stop_token());
  }

  void read_camera_poses(const std::string& path) {
    if (path.empty()) return;
    for (const io::CameraPose& camera : or_throw(io::read_camera_poses(path))) {
      camera_poses_[camera.name] = camera.scene_from_camera;
    }
  }

  /// Hands frames of all cameras to the search when they are complete.
  void take_view(IncomingFrame&& incoming) {
    statistics_.add_frame(clock_->stamp_ns() - incoming.stamp_ns);
    std::size_t displaced = 0;
    auto views = gate_->add(std::move(incoming), displaced);
    for (std::size_t i = 0; i < displaced; ++i) statistics_.add(&Counts::frames_dropped);
    if (!views) return;
    IncomingFrame all;
    all.frame_id = settings_.get()->tracking.fixed_frame;
    for (const IncomingFrame& view : *views) all.stamp_ns = std::max(all.stamp_ns, view.stamp_ns);
    all.views = *std::move(views);
    queue_->push(std::move(all));
  }

  void start_sources(const ServerOptions& options) {
    read_camera_poses(options.input.camera_poses);
    if (!options.input.views.empty()) {
      gate_.emplace(options.input.views,
                    static_cast<std::int64_t>(1e6 * options.input.views_tolerance_ms));
    }
    const auto on_frame = [this](IncomingFrame&& frame) { take(std::move(frame)); };
    ServerOptions topics = options;
    if (!options.capture.source.empty()) topics.input.depth.clear();  // they may be our own
    auto source = open_topic_source(*participant_, topics, on_frame, clock_, log_);
    topics_ = source.get();
    sources_.push_back(std::move(source));
    if (options.capture.source.empty()) return;
    const auto idle = [this] { return queue_->length() == 0; };
    sources_.push_back(open_camera_source(*participant_, options.capture, on_frame, idle,
                                          tracking_->transforms(), log_));
  }

  Status apply(const ServerOptions& before, const ServerOptions& after) {
    const auto changed = changed_parameters(before, after);
    if (std::ranges::any_of(changed,
                            [](const auto& p) { return p.name.starts_with("detector."); })) {
      if (Status status = recognition_->set_options(after.detector); !status.ok()) return status;
      statistics_.forget_timings();
    }
    Status status = clock_->simulate(*participant_, after.node.use_sim_time);
    if (!status.ok()) return status;
    tracking_->set_options(after.tracking);
    queue_->set_options(queue_options(after));
    topics_->set_options(after.input);
    relay_.set_level(log_level(after.log.level));
    return {};
  }

  ServiceContext context() {
    return {settings_,
            recognition_,
            *queue_,
            statistics_,
            advice_,
            [this] {
              statistics_.forget_timings();
              publisher_->publish_vision_info();
            },
            log_};
  }

  void open_page(const WebOptions& options) {
    page_ = web::open_page(
        options,
        {context(), setter_, [this] { return brief_status(); }, [this] { return diagnostics(); },
         [this](const auto& request, const auto& answer) {
           last_source()->record(request, answer);  // the camera, if any
         },
         [this] { return clock_->stamp_ns(); }},
        feed_, recent_log_);
    open_page_ = page_.get();
    // Not to /rosout: whoever reads the token may use the page.
    log(terminal_, LogLevel::info, "page: " + page_->address());
  }

  std::shared_ptr<FrameSource> last_source() const {
    const std::shared_lock<std::shared_mutex> lock(leaving_mutex_);
    return sources_.back();
  }

  void offer_services() {
    const ServiceContext context = this->context();
    services_.emplace(*participant_, log_, wire::qos::services());
    add_detect(context, *services_);
    add_detect_views(
        context,
        [this](const std::string& fixed_frame, const std::string& frame_id, std::int64_t stamp_ns) {
          return camera_at(fixed_frame, frame_id, stamp_ns);
        },
        *services_);
    add_library_services(context, *services_);
    add_track_services(*tracking_, *services_);
    services_->add_quick<msgs::GetStatus>(
        "get_status", [this](const msgs::GetStatus_Request&) { return status(); });
  }

  void on_result(const IncomingFrame& incoming, const Frame* frame,
                 const Result<SceneInterpretations>& result) {
    const int models = static_cast<int>(recognition_->models().size());
    const auto settings = settings_.get();
    const bool of_one_view = result.ok() && frame != nullptr;  // else in the fixed frame
    publisher_->publish(frame, result,
                        {incoming.stamp_ns, incoming.frame_id, models, settings->detection.seed,
                         of_one_view ? advice_.known(*frame, *result) : ""});
    if (!result.ok()) return log_failure(result.status());
    if (of_one_view) {
      tracking_->add(*result);
      const double range = settings->detector.surface.max_range_m;
      feed_.add_result(*frame, *result, advice_.on(*frame, *result, range));
    }
    const auto& found = result->interpretations;
    log(log_, LogLevel::debug,
        concat("frame ", incoming.stamp_ns, ": ", found.empty() ? 0 : found[0].placements.size(),
               " objects, ", found.size(), " interpretations, ",
               static_cast<long>(result->total_milliseconds), " ms"));
  }

  void log_failure(const Status& status) {
    const std::lock_guard<std::mutex> lock(failure_mutex_);
    const auto now = Clock::now();
    if (status.message == last_failure_ && now - last_logged_ < kRepeatAfter) return;
    last_failure_ = status.message;
    last_logged_ = now;
    log(log_, LogLevel::error, "frame not searched: " + status.message);
  }

  Counts counts() const {
    Counts counts = statistics_.counts();
    const std::shared_lock<std::shared_mutex> lock(leaving_mutex_);
    for (const auto& source : sources_) counts.losses += source->losses();
    if (ready_) {
      counts.losses += services_->losses();
      counts.losses += parameters_->losses();
    }
    counts.requests_refused += counts.losses.refused;
    return counts;
  }

  msgs::GetStatus_Response status() const {
    msgs::GetStatus_Response status = brief_status();
    status.stage_timings = to_message(statistics_.median_timings());
    status.details = details();
    return status;
  }

  /// Without what takes time to put together: stage timings and details.
  msgs::GetStatus_Response brief_status() const {
    const Counts counts = this->counts();
    const Settings::Snapshot options = settings_.get();
    const std::optional<double> silence = statistics_.seconds_since_frame();
    const bool idle = !silence || *silence > options->input.silence_s;
    const std::uint8_t state = !options->detection.continuous ? msgs::GetStatus_Response::kPaused
                               : idle                         ? msgs::GetStatus_Response::kIdle
                                                              : msgs::GetStatus_Response::kRunning;
    return {.success = true,
            .status = {},
            .version = BPA_VERSION,
            .state = state,
            .uptime_s = std::chrono::duration<double>(Clock::now() - started_).count(),
            .frames_received = counts.frames_received,
            .frames_processed = counts.frames_processed,
            .frames_dropped = counts.frames_dropped,
            .frames_rejected = counts.frames_rejected,
            .requests_served = counts.requests_served,
            .requests_refused = counts.requests_refused,
            .queue_length = static_cast<std::uint32_t>(queue_->length()),
            .queue_capacity =
                static_cast<std::uint32_t>(frame_capacity(*options) + options->queue.requests),
            .model_count = static_cast<std::uint32_t>(recognition_->models().size()),
            .library = recognition_->library(),
            .database_version = recognition_->version(),
            .memory_bytes = resident_bytes(),
            .stage_timings = {},
            .details = {},
            .frame_publishers = static_cast<std::uint32_t>(topics_->frame_publishers())};
  }

  std::vector<SourceReport> source_reports() const {
    std::vector<SourceReport> reports;
    const std::shared_lock<std::shared_mutex> lock(leaving_mutex_);
    for (const auto& source : sources_) {
      for (SourceReport& report : source->reports()) reports.push_back(std::move(report));
    }
    reports.push_back(tracking_->report());
    if (!clock_->is_real()) reports.push_back(clock_->report());
    if (web::Page* page = open_page_) reports.push_back(page->report());
    return reports;
  }

  std::vector<KeyValue> fusion() const {
    return fusion_values(statistics_, settings_.get()->detection.fuse_frames);
  }

  /// Of combined frames and of the group's workers.
  std::vector<KeyValue> more_values() const {
    std::vector<KeyValue> values = fusion();
    for (const WorkerState& worker : recognition_->workers()) {
      values.push_back({"worker " + worker.name,
                        worker.ready ? concat("ready, ", fixed(worker.ms_a_model, 0),
                                              " ms a model, ", worker.searches, " searches")
                                     : "not used: " + worker.problem});
    }
    return values;
  }

  std::vector<KeyValue> details() const {
    std::vector<KeyValue> details = more_values();
    details.push_back({"ms from the last frame's stamp until it came",
                       std::to_string(statistics_.last_age_ns() / 1'000'000)});
    if (const std::optional<double> silence = statistics_.seconds_since_frame()) {
      details.push_back({"s since the last frame came", fixed(*silence, 1)});
    }
    for (const auto& [cause, count] : drop_counts(statistics_)) {
      details.push_back({cause, std::to_string(count)});
    }
    for (KeyValue& loss : loss_values(counts().losses)) details.push_back(std::move(loss));
    for (const SourceReport& report : source_reports()) {
      details.insert(details.end(), report.values.begin(), report.values.end());
    }
    return details;
  }

  void report(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock<std::mutex> lock(mutex);
    while (!wake.wait_for(lock, stop, kReportPeriod, [&] { return stop.stop_requested(); })) {
      reporting_.begin("a report to /diagnostics");
      const Status status = guarded("no diagnostics", [&] { report_once(); });
      reporting_.end();
      if (!status.ok()) log(log_, LogLevel::error, status.message);
    }
  }

  wire::diagnostic_msgs::DiagnosticArray diagnostics() const {
    Rates rates;
    {
      const std::lock_guard<std::mutex> lock(rates_mutex_);
      rates = rates_.rates();
    }
    return diagnostics_message(
        {participant_->node().full(), status(), rates, drop_counts(statistics_), source_reports(),
         more_values(), statistics_.median_effort(), counts().losses, health().message},
        clock_->stamp_ns());
  }

  void report_once() {
    relay_.report_left_out();
    {
      const std::lock_guard<std::mutex> lock(rates_mutex_);
      rates_.add(Clock::now(), counts());
    }
    if (diagnostics_.wanted()) diagnostics_.send(diagnostics(), log_);
    report_losses();
    const bool stands_still = clock_->stands_still();
    if (stands_still && !clock_reported_) {
      log(log_, LogLevel::warning, clock_->report().message);
    }
    clock_reported_ = stands_still;
  }

  void report_losses() {
    const ros::SyncCounts sync = topics_->sync_counts();
    const std::uint64_t losses = sync.depth_without_color + sync.depth_without_info;
    // Says it at 10, 100, 1000 ... so that a camera that never fits is heard, and not for ever.
    if (losses < 10 || losses < 10 * losses_reported_) return;
    losses_reported_ = losses;
    log(log_, LogLevel::warning, sync_complaint(sync, settings_.get()->input));
  }

  Settings settings_;
  const std::shared_ptr<Recognition> recognition_;
  const LogHook terminal_;
  const web::RecentLog recent_log_;
  LogRelay relay_;
  const LogHook log_;
  const Clock::time_point started_ = Clock::now();
  const std::shared_ptr<RosClock> clock_ = std::make_shared<RosClock>();
  Statistics statistics_;
  web::Feed feed_;
  mutable std::mutex rates_mutex_;
  RateMeter rates_;
  std::mutex failure_mutex_;
  std::string last_failure_;       ///< Text of the last failed frame, and
  Clock::time_point last_logged_;  ///< when one was logged: the same is said once in 10 s.
  Advice advice_{log_};
  std::uint64_t losses_reported_ = 0;
  bool clock_reported_ = false;  ///< That it stands still.
  Busy reporting_;
  /// Guards what ends while other threads may still read it: services, page and sources.
  mutable std::shared_mutex leaving_mutex_;

  // In the order in which they come up; destroyed in reverse: nothing calls into what is gone.
  std::optional<wire::Participant> participant_;
  std::unique_ptr<ResultPublisher> publisher_;
  Output<wire::diagnostic_msgs::DiagnosticArray> diagnostics_;
  std::unique_ptr<TrackPublisher> track_publisher_;
  std::unique_ptr<Tracking> tracking_;
  std::optional<TransformSource> transforms_;
  std::unique_ptr<SearchQueue> queue_;
  std::map<std::string, Pose> camera_poses_;     ///< By frame_id, in tracking.fixed_frame.
  std::optional<ViewGate<IncomingFrame>> gate_;  ///< Of the cameras of one scene.
  std::vector<std::shared_ptr<FrameSource>> sources_;
  TopicSource* topics_ = nullptr;   ///< One of them.
  std::atomic<bool> ready_{false};  ///< All services are there.
  std::shared_ptr<ParameterSetter> setter_;
  std::optional<ServiceSet> services_;
  std::optional<ServiceSet> parameters_;
  std::unique_ptr<web::Page> page_;
  std::atomic<web::Page*> open_page_{nullptr};  ///< It, once it is open; for other threads.
  std::jthread reporter_;
};

}  // namespace

Result<std::unique_ptr<Server>> Server::create(const ServerOptions& options,
                                               std::shared_ptr<Recognition> recognition,
                                               LogHook log) {
  if (Status status = validate(options); !status.ok()) return status;
  auto server = std::make_unique<Running>(options, std::move(recognition), std::move(log));
  try {
    server->start();
  } catch (const Failure& failure) {
    return failure.status();
  } catch (const std::exception& error) {
    return status_of("the server cannot start", error);
  }
  return std::unique_ptr<Server>(std::move(server));
}

}  // namespace bpa::server
