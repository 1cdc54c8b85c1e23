// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <exception>
#include <utility>

#include <bpa/server/worker.hpp>

namespace bpa::server {
namespace {

bool same_search(const DetectRequest& a, const DetectRequest& b) {
  return a.models == b.models && a.top_k == b.top_k && a.budget_ms == b.budget_ms &&
         a.seed == b.seed;
}

}  // namespace

Worker::Worker(std::shared_ptr<const Recognition> recognition, const WorkerOptions& options,
               Statistics& statistics, OnResult on_result, LogHook log)
    : recognition_(std::move(recognition)),
      options_(options),
      statistics_(statistics),
      on_result_(std::move(on_result)),
      log_(std::move(log)),
      frames_(options.frame_capacity),
      thread_([this] { run(); }) {}

Worker::~Worker() { stop(); }

void Worker::stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
  const Status status(StatusCode::unavailable, "the server is stopping");
  for (const DetectJob& job : std::exchange(requests_, {})) job.done(nullptr, status);
  for (const DetectJob& job : std::exchange(awaiting_frame_, {})) job.done(nullptr, status);
}

void Worker::push(IncomingFrame frame) {
  std::optional<IncomingFrame> displaced;  // freed outside the lock
  statistics_.add_frame();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    displaced = frames_.push(std::move(frame));
  }
  if (displaced) statistics_.add(&Counts::frames_dropped);
  wake_.notify_one();
}

Result<std::size_t> Worker::push(DetectJob job) {
  const double search_ms = statistics_.median_total_ms();
  std::size_t before = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    before = requests_.size() + awaiting_frame_.size();
    if (stopping_) return Status(StatusCode::unavailable, "the server is stopping");
    if (before >= options_.request_capacity) {
      return Status(StatusCode::busy, std::to_string(before) +
                                          " requests are waiting, as many as may "
                                          "(queue.requests); try again later");
    }
    const auto wait = std::chrono::duration<double, std::milli>(
        search_ms * static_cast<double>(requests_.size()));
    if (Clock::now() + wait > job.deadline) {
      return Status(StatusCode::timeout,
                    "its turn would come in about " +
                        std::to_string(static_cast<long>(wait.count())) +
                        " ms, after its time-out; allow more time or try again later");
    }
    if (job.decode) {
      requests_.push_back(std::move(job));
    } else {
      awaiting_frame_.push_back(std::move(job));
    }
  }
  wake_.notify_one();
  return before;
}

Status Worker::run_later(std::function<void()> task) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (tasks_.size() >= options_.request_capacity) {
      return Status(StatusCode::busy, std::to_string(tasks_.size()) +
                                          " changes of the library are waiting, as many as may");
    }
    tasks_.push_back(std::move(task));
  }
  wake_.notify_one();
  return {};
}

std::size_t Worker::queue_length() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return frames_.size() + requests_.size() + awaiting_frame_.size();
}

bool Worker::has_work() const {
  const bool frame_wanted = options_.continuous || !awaiting_frame_.empty();
  return !tasks_.empty() || !requests_.empty() || (!frames_.empty() && frame_wanted);
}

std::optional<Clock::time_point> Worker::first_deadline() const {
  std::optional<Clock::time_point> first;
  for (const DetectJob& job : awaiting_frame_) {
    if (!first || job.deadline < *first) first = job.deadline;
  }
  return first;
}

std::vector<DetectJob> Worker::take_expired() {
  std::vector<DetectJob> expired;
  const auto now = Clock::now();
  for (auto job = awaiting_frame_.begin(); job != awaiting_frame_.end();) {
    if (job->deadline <= now) {
      expired.push_back(std::move(*job));
      job = awaiting_frame_.erase(job);
    } else {
      ++job;
    }
  }
  return expired;
}

void Worker::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stopping_) {
    std::vector<DetectJob> expired = take_expired();
    if (!expired.empty()) {
      lock.unlock();
      expire(std::move(expired));
      lock.lock();
      continue;
    }
    if (!has_work()) {
      const auto deadline = first_deadline();
      if (deadline) {
        wake_.wait_until(lock, *deadline);
      } else {
        wake_.wait(lock);
      }
      continue;
    }
    if (!tasks_.empty()) {
      const std::function<void()> task = std::move(tasks_.front());
      tasks_.pop_front();
      lock.unlock();
      task();
      lock.lock();
      continue;
    }
    const bool frame_wanted = options_.continuous || !awaiting_frame_.empty();
    const bool take_frame =
        !frames_.empty() && frame_wanted && (requests_.empty() || !frame_was_last_);
    frame_was_last_ = take_frame;
    if (take_frame) {
      IncomingFrame incoming = *frames_.pop();
      std::vector<DetectJob> waiting = std::exchange(awaiting_frame_, {});
      lock.unlock();
      work_on_frame(std::move(incoming), std::move(waiting));
    } else {
      DetectJob job = std::move(requests_.front());
      requests_.pop_front();
      lock.unlock();
      work_on_request(std::move(job));
    }
    lock.lock();
  }
}

void Worker::expire(std::vector<DetectJob> jobs) {
  for (const DetectJob& job : jobs) {
    statistics_.add(&Counts::requests_refused);
    job.done(nullptr, Status(StatusCode::timeout,
                             "no usable frame came in time; is a camera publishing, or does the "
                             "request want to carry a frame of its own?"));
  }
}

void Worker::work_on_frame(IncomingFrame incoming, std::vector<DetectJob> waiting) {
  Result<Frame> frame = incoming.decode();
  if (!frame.ok()) {
    statistics_.add_rejection(frame.status().message);
    const std::lock_guard<std::mutex> lock(mutex_);  // the jobs go on waiting for a better frame
    awaiting_frame_.insert(awaiting_frame_.begin(), std::make_move_iterator(waiting.begin()),
                           std::make_move_iterator(waiting.end()));
  }
  if (!frame.ok()) {  // the lock is released
    on_result_(incoming, nullptr, frame.status());
    return;
  }
  std::optional<Result<SceneInterpretations>> result;
  if (options_.continuous) {
    result.emplace(detect(*frame, options_.request));
    statistics_.add(result->ok() ? &Counts::frames_processed : &Counts::frames_failed);
    on_result_(incoming, &*frame, *result);
  }
  for (const DetectJob& job : waiting) {
    answer_next_frame(*frame, job, result ? &*result : nullptr);
  }
}

void Worker::answer_next_frame(const Frame& frame, const DetectJob& job,
                               const Result<SceneInterpretations>* shared) {
  if (shared != nullptr && !job.restrict_frame && same_search(job.request, options_.request)) {
    statistics_.add(&Counts::requests_served);
    job.done(&frame, *shared);
    return;
  }
  Frame narrowed = frame;
  if (job.restrict_frame) {
    if (Status status = job.restrict_frame(narrowed); !status.ok()) {
      statistics_.add(&Counts::requests_refused);
      job.done(nullptr, status);
      return;
    }
  }
  const Result<SceneInterpretations> result = detect(narrowed, job.request);
  statistics_.add(result.ok() ? &Counts::requests_served : &Counts::requests_refused);
  job.done(&narrowed, result);
}

void Worker::work_on_request(DetectJob job) {
  if (Clock::now() >= job.deadline) {
    statistics_.add(&Counts::requests_refused);
    job.done(nullptr, Status(StatusCode::timeout, "its turn came after its time-out"));
    return;
  }
  const Result<Frame> frame = job.decode();
  if (!frame.ok()) {
    statistics_.add(&Counts::requests_refused);
    job.done(nullptr, frame.status());
    return;
  }
  const Result<SceneInterpretations> result = detect(*frame, job.request);
  statistics_.add(result.ok() ? &Counts::requests_served : &Counts::requests_refused);
  job.done(&*frame, result);
}

Result<SceneInterpretations> Worker::detect(const Frame& frame, const DetectRequest& request) {
  try {
    Result<SceneInterpretations> result = recognition_->detect(frame, request);
    if (result.ok()) statistics_.add_timings(*result);
    return result;
  } catch (const std::exception& error) {
    log(log_, LogLevel::error, std::string("the detector failed: ") + error.what());
    return Status(StatusCode::internal, std::string("the detector failed: ") + error.what());
  }
}

}  // namespace bpa::server
