// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/search_queue.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "core/base/concat.hpp"
#include "core/base/guarded.hpp"
#include "server/niceness.hpp"

namespace bpa::server {
namespace {

bool same_search(const DetectRequest& a, const DetectRequest& b) {
  return a.models == b.models && a.top_k == b.top_k && a.budget_ms == b.budget_ms &&
         a.seed == b.seed;
}

// Cameras whose last result is remembered; names of frames come from the wire.
constexpr std::size_t kFollowedCameras = 16;
constexpr std::size_t kMaxCameras = 16;  // whose frames wait; names come from the wire
constexpr std::size_t kMaxHelpers = 63;

/// The request about a frame that came with priors of its own.
DetectRequest with_priors(DetectRequest request, const std::vector<PosePrior>& priors) {
  request.priors.insert(request.priors.end(), priors.begin(), priors.end());
  return request;
}

}  // namespace

SearchQueue::SearchQueue(std::shared_ptr<const Recognition> recognition,
                         const SearchQueueOptions& options, Statistics& statistics,
                         OnResult on_result, LogHook log, std::shared_ptr<WaitableClock> clock,
                         std::shared_ptr<WaitableClock> ros_clock)
    : recognition_(std::move(recognition)),
      statistics_(statistics),
      on_result_(std::move(on_result)),
      log_(std::move(log)),
      clock_(std::move(clock)),
      ros_clock_(ros_clock ? std::move(ros_clock) : clock_),
      busy_(clock_),
      options_(options),
      thread_([this] { run(); }) {}

SearchQueue::~SearchQueue() { stop(); }

void SearchQueue::stop() {
  stop_taking(unavailable("the server is stopping"));
  if (thread_.joinable()) thread_.join();
  for (Helper& helper : helpers_) {  // no thread is left that makes more
    if (helper.thread.joinable()) helper.thread.join();
  }
  refuse_waiting();
}

std::vector<const Busy*> SearchQueue::threads() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<const Busy*> threads = {&busy_};
  for (const Helper& helper : helpers_) threads.push_back(&helper.busy);
  return threads;
}

void SearchQueue::abandon(const Status& why) {
  stop_taking(why);
  refuse_waiting();
}

void SearchQueue::leave_to_another() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    silent_ = true;
  }
  stop_taking(unavailable("another server has taken over"));
}

void SearchQueue::stop_taking(const Status& why) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!stopping_) why_stopping_ = why;
  stopping_ = true;
  wake_.notify_all();
}

void SearchQueue::refuse_waiting() {
  std::unique_lock<std::mutex> lock(mutex_);
  const Status why = why_stopping_;
  std::vector<DetectJob> jobs = std::exchange(awaiting_frame_, {});
  while (auto job = requests_.pop()) jobs.push_back(*std::move(job));
  std::vector<Errand> errands;
  while (auto errand = errands_.pop()) errands.push_back(*std::move(errand));
  const bool silent = silent_;
  lock.unlock();
  if (silent) return;
  for (DetectJob& job : jobs) hand_over(job, nullptr, why);
  for (const Errand& errand : errands) errand.refuse(why);
}

void SearchQueue::push(IncomingFrame frame) {
  std::optional<IncomingFrame> displaced;  // freed outside the lock
  // Those of several views are counted as they come.
  if (frame.views.empty()) statistics_.add_frame(ros_clock_->stamp_ns() - frame.stamp_ns);
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto of_camera = [&](const IncomingFrame& other) {
    return other.frame_id == frame.frame_id;
  };
  const auto waiting = static_cast<std::size_t>(std::ranges::count_if(frames_, of_camera));
  auto oldest = frames_.end();
  if (waiting >= std::max<std::size_t>(options_.frame_capacity, 1)) {
    oldest = std::ranges::find_if(frames_, of_camera);
  } else if (frames_.size() >= options_.frame_capacity * kMaxCameras) {
    oldest = frames_.begin();
  }
  if (oldest != frames_.end()) {
    displaced = std::move(*oldest);
    frames_.erase(oldest);
    for (std::size_t i = 0; i < std::max<std::size_t>(displaced->views.size(), 1); ++i) {
      statistics_.add(&Counts::frames_dropped);
    }
  }
  frames_.push_back(std::move(frame));
  call_helpers();
}

void SearchQueue::set_options(const SearchQueueOptions& options) {
  const std::lock_guard<std::mutex> lock(mutex_);
  options_ = options;
  wake_.notify_all();
}

/// Until the job's answer could be there: what is left of the search that runs, those ahead of it,
/// frames of the stream in between, and its own. How long a search for some of the models takes is
/// not known beforehand, so that such a job is given the benefit of the doubt.
double SearchQueue::wait_ms(const DetectJob& job) const {
  const double search_ms = statistics_.median_total_ms();
  double wait = 0;
  if (const auto work = busy_.work()) wait += std::max(0.0, search_ms - 1e3 * work->seconds);
  const auto at_once = static_cast<double>(recognition_->searches_at_once());
  if (job.decode) wait += search_ms * static_cast<double>(job.position) / at_once;
  if (!job.request.models.empty()) return wait;
  const double own_ms = statistics_.shortest_total_ms();
  return wait + (job.request.budget_ms > 0 ? std::min(own_ms, job.request.budget_ms) : own_ms);
}

/// Takes out the job that must make room for one of `client` in a full queue; nothing when no other
/// client would still have as many.
std::optional<DetectJob> SearchQueue::displace_for(const wire::Guid& client) {
  std::map<wire::Guid, std::size_t> held{{client, 0}};
  for (const auto& [other, count] : requests_.counts()) held[other] += count;
  for (const DetectJob& job : awaiting_frame_) ++held[job.client];
  const auto most = std::ranges::max_element(held, {}, [](const auto& one) { return one.second; });
  if (most->second < held[client] + 2) return std::nullopt;
  if (auto job = requests_.pop_last(most->first)) return job;
  const auto last = std::ranges::find(awaiting_frame_.rbegin(), awaiting_frame_.rend(), most->first,
                                      &DetectJob::client);
  std::optional<DetectJob> job(std::move(*last));
  awaiting_frame_.erase(std::next(last).base());
  return job;
}

Status SearchQueue::push(DetectJob job) {
  std::optional<DetectJob> displaced;
  Status status;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    status = admit(std::move(job), displaced);
  }
  if (displaced) {
    refuse(*displaced, Status(StatusCode::busy,
                              "other clients wait with fewer requests; ask for "
                              "less at once, or try again later"));
  }
  return status;
}

Status SearchQueue::admit(DetectJob job, std::optional<DetectJob>& displaced) {
  if (stopping_) return silent_ ? Status() : why_stopping_;
  const std::size_t waiting = requests_.size() + awaiting_frame_.size();
  if (waiting >= options_.request_capacity) {
    displaced = displace_for(job.client);
    if (!displaced) {
      return Status(StatusCode::busy, concat(waiting,
                                             " requests are waiting, as many as may "
                                             "(queue.requests); try again later"));
    }
  }
  if (job.decode) {
    job.position = requests_.ahead_of_next(job.client);
    // Frames of the stream have every other turn.
    const bool streaming = options_.continuous && !frames_.empty();
    if (streaming) job.position += job.position + (frame_was_last_ ? 0 : 1);
  } else {
    job.position = awaiting_frame_.size();
  }
  job.deadline = ros_clock_->now() + job.timeout;
  const double wait = wait_ms(job);
  if (ros_clock_->is_real() && std::chrono::duration<double, std::milli>(wait) > job.timeout) {
    return Status(StatusCode::timeout,
                  concat("its answer would come in about ", static_cast<long>(wait),
                         " ms, after its time-out; allow more time or try again later"));
  }
  if (job.decode) {
    const wire::Guid client = job.client;
    requests_.push(client, std::move(job));
  } else {
    awaiting_frame_.push_back(std::move(job));
  }
  call_helpers();
  return {};
}

/// Wakes the threads; makes one more where a search waits that could run beside the others. The
/// caller holds the mutex.
void SearchQueue::call_helpers() {
  wake_.notify_all();
  const std::size_t at_once = recognition_->searches_at_once();
  const bool room = searching_ + idle_helpers_ < at_once && 1 + helpers_.size() < at_once;
  if (stopping_ || searching_ == 0 || !room || helpers_.size() >= kMaxHelpers) return;
  Helper& helper = helpers_.emplace_back(clock_);
  helper.thread = std::thread([this, &helper] { help(helper.busy); });
}

/// Searches beside the first thread, as many frames at once as there may be.
void SearchQueue::help(Busy& busy) {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stopping_) {
    const SearchQueueOptions options = options_;
    // Frames are combined, and taken by requests that wait for one, in the first thread.
    const bool frame = options.continuous && options.fuse_frames == 1 && awaiting_frame_.empty() &&
                       next_frame() != frames_.end();
    const bool room = searching_ > 0 && searching_ < recognition_->searches_at_once();
    if (room && !requests_.empty()) {
      search_request(lock, busy);
    } else if (room && frame) {
      search_frames(lock, options, busy);
    } else {
      ++idle_helpers_;
      wake_.wait(lock);
      --idle_helpers_;
    }
  }
}

/// The oldest frame whose camera has none in search; the caller holds the mutex.
std::deque<IncomingFrame>::iterator SearchQueue::next_frame() {
  return std::ranges::find_if(
      frames_, [&](const IncomingFrame& frame) { return !in_search_.contains(frame.frame_id); });
}

void SearchQueue::run_later(const wire::Guid& client, Errand errand) {
  std::unique_lock<std::mutex> lock(mutex_);
  if (silent_) return;
  const bool stopping = stopping_;
  const Status why = why_stopping_;
  const bool full = errands_.size() >= options_.request_capacity;
  std::optional<Errand> displaced =
      full && !stopping ? errands_.displace_for(client) : std::nullopt;
  const bool taken = !stopping && (!full || displaced);
  if (taken) errands_.push(client, std::move(errand));
  wake_.notify_all();
  lock.unlock();
  const Status busy(StatusCode::busy,
                    "as many changes of the library wait as may (queue.requests); try again later");
  if (displaced) displaced->refuse(busy);
  if (!taken) errand.refuse(stopping ? why : busy);
}

std::size_t SearchQueue::length() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return frames_.size() + requests_.size() + awaiting_frame_.size();
}

bool SearchQueue::has_work() {
  const bool frame_wanted = options_.continuous || !awaiting_frame_.empty();
  return !errands_.empty() || !requests_.empty() || (frame_wanted && next_frame() != frames_.end());
}

std::vector<DetectJob> SearchQueue::take_expired() {
  const auto end = std::stable_partition(
      awaiting_frame_.begin(), awaiting_frame_.end(),
      [now = ros_clock_->now()](const DetectJob& job) { return job.deadline > now; });
  std::vector<DetectJob> expired(std::make_move_iterator(end),
                                 std::make_move_iterator(awaiting_frame_.end()));
  awaiting_frame_.erase(end, awaiting_frame_.end());
  return expired;
}

void SearchQueue::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stopping_) {
    if (std::vector<DetectJob> expired = take_expired(); !expired.empty()) {
      lock.unlock();
      for (DetectJob& job : expired) {
        refuse(job, Status(StatusCode::timeout,
                           "no usable frame came in time; is a camera publishing, or does the "
                           "request want to carry a frame of its own?"));
      }
      lock.lock();
    } else if (has_work()) {
      run_one(lock);
    } else if (awaiting_frame_.empty()) {
      wake_.wait(lock);
    } else {
      const auto first = std::ranges::min_element(awaiting_frame_, {}, &DetectJob::deadline);
      ros_clock_->wait_until(wake_, lock, first->deadline);
    }
  }
}

/// Takes one task, frame or request out and works on it with no lock held.
void SearchQueue::run_one(std::unique_lock<std::mutex>& lock) {
  const SearchQueueOptions options = options_;
  const bool tracked = options.tracked && options.tracked();
  if (const int added = tracked ? options.added_nice : 0; added != niceness_) {
    if (set_niceness(niceness() - niceness_ + added)) niceness_ = added;
  }
  const bool frame_wanted = options.continuous || !awaiting_frame_.empty();
  const bool take_frame =
      frame_wanted && next_frame() != frames_.end() && (requests_.empty() || !frame_was_last_);
  if (const std::optional<Errand> errand = errands_.pop()) {
    busy_.begin("a change of the library");
    lock.unlock();
    (void)guard("a change of the library failed", errand->handle);
    lock.lock();
    busy_.end();
  } else if (take_frame) {
    search_frames(lock, options, busy_);
  } else {
    search_request(lock, busy_);
  }
}

/// Takes frames out and searches them with no lock held.
void SearchQueue::search_frames(std::unique_lock<std::mutex>& lock,
                                const SearchQueueOptions& options, Busy& busy) {
  frame_was_last_ = true;
  busy.begin("the search of a frame");
  std::vector<IncomingFrame> taken = take_frames(options);
  std::vector<DetectJob> waiting = std::exchange(awaiting_frame_, {});
  const std::string camera = taken.front().frame_id;
  in_search_.insert(camera);
  ++searching_;
  call_helpers();
  lock.unlock();
  const Status status = guard("the search of a frame failed",
                              [&] { work_on_frames(options, std::move(taken), waiting); });
  for (DetectJob& job : waiting) refuse_failed(job, status);
  lock.lock();
  --searching_;
  in_search_.erase(camera);
  wake_.notify_all();  // another frame of the camera may wait
  busy.end();
}

void SearchQueue::search_request(std::unique_lock<std::mutex>& lock, Busy& busy) {
  frame_was_last_ = false;
  busy.begin("the search of a request's frame");
  DetectJob job = *requests_.pop();
  ++searching_;
  call_helpers();
  lock.unlock();
  refuse_failed(job, guard("a request failed", [&] { work_on_request(job); }));
  lock.lock();
  --searching_;
  wake_.notify_all();
  busy.end();
}

/// The failure of work that threw, which is logged.
Status SearchQueue::guard(const char* about, const std::function<void()>& work) {
  const Status status = guarded(about, work);
  if (!status.ok()) log(log_, LogLevel::error, status.message);
  return status;
}

ros::DecodedFrame SearchQueue::decoded(Once<ros::DecodedFrame> decode) {
  std::optional<ros::DecodedFrame> frame;
  const Status status =
      guard("a frame cannot be decoded", [&] { frame.emplace(std::move(decode)()); });
  if (!status.ok()) return {ros::RejectionCause::frame, status};
  if (!frame->note().empty() && !noted_.exchange(true)) {
    log(log_, LogLevel::warning, "frame of " + (*frame)->frame_id + ": " + frame->note());
  }
  return *std::move(frame);
}

/// Calls job.done, once.
void SearchQueue::hand_over(DetectJob& job, const Frame* frame,
                            const Result<SceneInterpretations>& result) {
  const auto done = std::exchange(job.done, nullptr);
  (void)guard("a request was not answered", [&] { done(job, frame, result); });
}

void SearchQueue::refuse(DetectJob& job, const Status& status) {
  statistics_.add(&Counts::requests_refused);
  hand_over(job, nullptr, status);
}

/// Answers a job that was not answered before its work failed.
void SearchQueue::refuse_failed(DetectJob& job, const Status& status) {
  if (!status.ok() && job.done) refuse(job, status);
}

void SearchQueue::answer(DetectJob& job, const Frame& frame, const DetectRequest& request) {
  const Result<SceneInterpretations> result = detect(frame, request);
  statistics_.add(result.ok() ? &Counts::requests_served : &Counts::requests_refused);
  hand_over(job, &frame, result);
}

/// The oldest, or all that wait where they are combined.
std::vector<IncomingFrame> SearchQueue::take_frames(const SearchQueueOptions& options) {
  std::vector<IncomingFrame> taken;
  do {
    const auto next = next_frame();
    taken.push_back(std::move(*next));
    frames_.erase(next);
    if (taken.back().taken) taken.back().taken();
  } while (options.fuse_frames > 1 && combines_next(taken.front()));
  return taken;
}

/// Whether a further frame can be searched as one with this: neither is several views. The caller
/// holds the mutex.
bool SearchQueue::combines_next(const IncomingFrame& first) {
  const auto next = next_frame();
  return first.views.empty() && next != frames_.end() && next->views.empty();
}

void SearchQueue::note_restart(const std::string& reason) {
  if (reason.empty()) return;
  statistics_.add_fusion_restart(reason);
  if (last_fused_ > 1) log(log_, LogLevel::info, "frames are combined anew: " + reason);
}

void SearchQueue::work_on_frames(const SearchQueueOptions& options,
                                 std::vector<IncomingFrame> taken,
                                 std::vector<DetectJob>& waiting) {
  if (!taken.front().views.empty()) {
    keep_waiting(waiting);
    return work_on_views(options, std::move(taken.front()));
  }
  {
    const std::lock_guard<std::mutex> lock(stream_mutex_);
    fusion_.set_max_frames(options.fuse_frames);
  }
  std::optional<Frame> frame;  // the newest that can be used
  const IncomingFrame* newest = nullptr;
  for (IncomingFrame& incoming : taken) {
    ros::DecodedFrame made = decoded(std::move(incoming.decode));
    if (!made.ok()) {
      statistics_.add_rejection(made.cause());
      publish(incoming, nullptr, made.status());
      continue;
    }
    if (newest) {
      statistics_.add(&Counts::frames_fused);
      const std::lock_guard<std::mutex> lock(stream_mutex_);
      note_restart(fusion_.hold(*frame));
    }
    frame = std::move(made).value();
    newest = &incoming;
  }
  if (!newest) return keep_waiting(waiting);
  frame = fuse(*std::move(frame), options);
  std::optional<Result<SceneInterpretations>> result;
  if (options.continuous) {
    DetectRequest request = with_priors(options.request, newest->priors);
    if (options.follow) request.expected = expected_in(options, *frame);
    if (options.tracked && options.tracked()) request.on_round = options.on_round;
    result.emplace(detect(*frame, request));
    remember(*frame, *result);
    statistics_.add(result->ok() ? &Counts::frames_processed : &Counts::frames_failed);
    publish(*newest, &*frame, *result);
  }
  for (DetectJob& job : waiting) {
    refuse_failed(job, guard("a request failed", [&] {
                    answer_next_frame(options, *newest, *frame, job, result ? &*result : nullptr);
                  }));
  }
}

/// The jobs go on waiting for a better frame.
void SearchQueue::keep_waiting(std::vector<DetectJob>& waiting) {
  const std::lock_guard<std::mutex> lock(mutex_);
  awaiting_frame_.insert(awaiting_frame_.begin(), std::make_move_iterator(waiting.begin()),
                         std::make_move_iterator(waiting.end()));
  waiting.clear();
}

void SearchQueue::work_on_views(const SearchQueueOptions& options, IncomingFrame incoming) {
  std::vector<IncomingFrame> views = std::move(incoming.views);
  Result<SceneInterpretations> result = search_views(options, views);
  if (result.ok()) result->frame_id = incoming.frame_id;
  publish(incoming, nullptr, result);
}

/// Counts each of the frames.
Result<SceneInterpretations> SearchQueue::search_views(const SearchQueueOptions& options,
                                                       std::vector<IncomingFrame>& incoming) {
  std::vector<View> views;
  Status failed;
  std::size_t rejected = 0;
  for (IncomingFrame& one : incoming) {
    ros::DecodedFrame made = decoded(std::move(one.decode));
    if (!made.ok()) {
      statistics_.add_rejection(made.cause());
      ++rejected;
      failed = made.status();
      continue;
    }
    const Result<Pose> camera = options.camera(one.frame_id, one.stamp_ns);
    if (!camera.ok()) failed = camera.status();
    views.push_back({std::move(made).value(), camera.ok() ? *camera : Pose(), one.priors});
  }
  const auto detect_all = [&]() -> Result<SceneInterpretations> {
    if (!failed.ok()) return failed;
    Result<ViewsResult> found = recognition_->detect_views(views, options.request);
    if (!found.ok()) return found.status();
    for (const std::string& warning : found->warnings) log(log_, LogLevel::warning, warning);
    return std::move(found->scene);
  };
  Result<SceneInterpretations> result = searched(detect_all);
  for (std::size_t i = rejected; i < incoming.size(); ++i) {
    statistics_.add(result.ok() ? &Counts::frames_processed : &Counts::frames_failed);
  }
  return result;
}

void SearchQueue::publish(const IncomingFrame& incoming, const Frame* frame,
                          const Result<SceneInterpretations>& result) {
  const std::lock_guard<std::mutex> lock(publish_mutex_);
  (void)guard("a result was not published", [&] { on_result_(incoming, frame, result); });
}

Frame SearchQueue::fuse(Frame frame, const SearchQueueOptions& options) {
  const std::lock_guard<std::mutex> lock(stream_mutex_);
  FusedFrame fused = fusion_.add(std::move(frame), options.request.num_threads);
  note_restart(fused.restart);
  last_fused_ = fused.frame.fused;
  return std::move(fused.frame);
}

std::vector<ExpectedPlacement> SearchQueue::expected_in(const SearchQueueOptions& options,
                                                        const Frame& frame) {
  if (options.expected) {
    if (auto tracked = options.expected(frame.frame_id)) return *std::move(tracked);
  }
  const std::lock_guard<std::mutex> lock(stream_mutex_);
  return expected_[frame.frame_id];
}

void SearchQueue::remember(const Frame& frame, const Result<SceneInterpretations>& result) {
  const std::lock_guard<std::mutex> lock(stream_mutex_);
  if (expected_.size() > kFollowedCameras) expected_.clear();
  expected_[frame.frame_id] =
      result.ok() ? expected_after(*result) : std::vector<ExpectedPlacement>{};
}

void SearchQueue::answer_next_frame(const SearchQueueOptions& options,
                                    const IncomingFrame& incoming, const Frame& frame,
                                    DetectJob& job, const Result<SceneInterpretations>* shared) {
  if (shared != nullptr && !job.restrict_frame && same_search(job.request, options.request)) {
    statistics_.add(&Counts::requests_served);
    return hand_over(job, &frame, *shared);
  }
  Frame narrowed = frame;
  if (job.restrict_frame) {
    if (Status status = job.restrict_frame(narrowed); !status.ok()) return refuse(job, status);
  }
  answer(job, narrowed, with_priors(job.request, incoming.priors));
}

void SearchQueue::work_on_request(DetectJob& job) {
  if (ros_clock_->now() >= job.deadline) {
    return refuse(job, Status(StatusCode::timeout, "its turn came after its time-out"));
  }
  const ros::DecodedFrame frame = decoded(std::move(job.decode));
  if (!frame.ok()) return refuse(job, frame.status());
  answer(job, *frame, job.request);
}

Result<SceneInterpretations> SearchQueue::detect(const Frame& frame, const DetectRequest& request) {
  return searched([&] { return recognition_->detect_beside(frame, request, length()); });
}

/// What a search finds, which may throw; its times are counted.
Result<SceneInterpretations> SearchQueue::searched(
    const std::function<Result<SceneInterpretations>()>& search) {
  std::optional<Result<SceneInterpretations>> result;
  const Status status = guard("the detector failed", [&] { result.emplace(search()); });
  if (!status.ok()) return status;
  if (result->ok()) statistics_.add_timings(**result);
  return *std::move(result);
}

}  // namespace bpa::server
