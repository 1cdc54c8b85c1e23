// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/worker.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <iterator>
#include <list>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "core/base/guarded.hpp"
#include "core/base/parallel.hpp"
#include "core/base/stopwatch.hpp"
#include "core/io/file_bytes.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/status.hpp"
#include "idl/wire/subscriber.hpp"
#include "server/busy.hpp"
#include "server/convert/results.hpp"
#include "server/group/messages.hpp"
#include "server/group/session.hpp"
#include "server/group/topics.hpp"

namespace bpa::server::group {
namespace {

namespace msgs = wire::bpa_msgs;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr auto kFetchTime = std::chrono::seconds(10);  // for one part of a file
constexpr auto kRetryFetch = std::chrono::seconds(2);
constexpr std::size_t kMaxShares = 64;  // of all searches at once
constexpr std::size_t kLibraries = 2;   // kept: searches that run go on with the one before

class RunningWorker : public Worker {
 public:
  RunningWorker(const wire::Participant& participant, const WorkerSettings& settings, LogHook log)
      : settings_(settings),
        topics_(settings.group),
        log_(std::move(log)),
        id_(new_session()),
        cache_(settings.cache) {
    or_throw(io::make_folder(settings.cache), "the workers' cache");
    answers_.emplace(or_throw(
        wire::Publisher<msgs::GroupAnswer>::create(participant, topics_.answers(), {qos()})));
    heartbeats_.emplace(or_throw(
        wire::Publisher<msgs::GroupWorker>::create(participant, topics_.workers(), {qos()})));
    files_.emplace(or_throw(
        wire::ServiceClient<msgs::GetModelFile>::create(participant, topics_.model_files())));
    offers_.emplace(or_throw(wire::Subscriber<msgs::GroupLibrary>::create(
        participant, topics_.library(), {qos()},
        [this](msgs::GroupLibrary&& offer, const wire::SampleMeta&) { take(std::move(offer)); })));
    loader_ = std::jthread([this](const std::stop_token& stop) { load(stop); });
    tasks_.emplace(or_throw(wire::Subscriber<msgs::GroupTask>::create(
        participant, topics_.tasks(id_), {qos()},
        [this](msgs::GroupTask&& task, const wire::SampleMeta&) { take(std::move(task)); })));
    beating_ = std::jthread([this](const std::stop_token& stop) { beat(stop); });
  }

  ~RunningWorker() override {
    tasks_.reset();
    offers_.reset();
    for (std::jthread* thread : {&beating_, &loader_}) {
      thread->request_stop();
      changed_.notify_all();
      thread->join();
    }
    for (Share& share : shares_) share.thread.join();
  }

  Status health(double limit_s) const override {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const Share& share : shares_) {
      const auto work = share.busy.work();
      if (!work || work->seconds <= limit_s) continue;
      return Status(StatusCode::internal, concat(work->name, " has not ended for ",
                                                 fixed(work->seconds, 1), " s: it hangs"));
    }
    return {};
  }

 private:
  struct Share {
    explicit Share(msgs::GroupTask&& given) : task(std::move(given)) {}

    msgs::GroupTask task;
    Busy busy;
    std::atomic<bool> done{false};
    std::thread thread;
  };

  // On a DDS thread.
  void take(msgs::GroupTask&& task) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (shares_.size() >= kMaxShares) {
      msgs::GroupAnswer refusal = answer_to(task);
      refusal.status = server::to_message(
          Status(StatusCode::busy, concat("searches ", kMaxShares, " shares, as many as it may")));
      (void)answers_->publish(refusal);
      return;
    }
    Share& share = shares_.emplace_back(std::move(task));
    share.thread = std::thread([this, &share] {
      share.busy.begin("the search of a share");
      (void)answers_->publish(searched(std::move(share.task)));
      share.busy.end();
      share.done = true;
    });
  }

  /// Without what was found.
  msgs::GroupAnswer answer_to(const msgs::GroupTask& task) const {
    msgs::GroupAnswer answer;
    answer.front = task.front;
    answer.search = task.search;
    answer.share = task.share;
    answer.worker = id_;
    return answer;
  }

  msgs::GroupAnswer searched(msgs::GroupTask&& task) {
    const Stopwatch watch;
    msgs::GroupAnswer answer = answer_to(task);
    const Status status = guarded("the search of a share failed",
                                  [&] { put_result(or_throw(search(std::move(task))), answer); });
    answer.status = server::to_message(status);
    answer.busy_ms = watch.milliseconds();
    return answer;
  }

  Result<SearchResult> search(msgs::GroupTask&& message) {
    const std::shared_ptr<const SharedLibrary> library = find(message.library);
    if (!library) return not_found("this worker has no library ", message.library);
    auto detector = detector_of(*library, message.options);
    if (!detector.ok()) return detector.status();
    Result<Task> task = task_from(std::move(message), *library);
    if (!task.ok()) return task.status();
    task->request.num_threads = settings_.threads;
    return (*detector)->search(task->frame, task->request);
  }

  /// Kept from task to task: it learns what searches cost here.
  Result<std::shared_ptr<const Detector>> detector_of(const SharedLibrary& library,
                                                      const std::vector<std::string>& options) {
    const std::lock_guard<std::mutex> lock(detector_mutex_);
    if (!detector_ || detector_library_ != library.offer.digest || detector_options_ != options) {
      const Result<DetectorOptions> read = options_from(options);
      if (!read.ok()) return read.status();
      detector_ = std::make_shared<const Detector>(
          std::make_shared<const ModelLibrary>(library.models), *read, library.layers);
      detector_library_ = library.offer.digest;
      detector_options_ = options;
    }
    return detector_;
  }

  std::shared_ptr<const SharedLibrary> find(const std::string& digest) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& library : libraries_) {
      if (library->offer.digest == digest) return library;
    }
    return nullptr;
  }

  void keep(std::shared_ptr<const SharedLibrary> library) {
    libraries_.push_front(std::move(library));
    if (libraries_.size() > kLibraries) libraries_.pop_back();
  }

  void take(msgs::GroupLibrary&& offer) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (wanted_ && wanted_->digest == offer.digest) return;
    if (offer.score_layers.empty()) return;  // all of it comes when the front knows that we lack it
    wanted_ = std::move(offer);
    changed_.notify_all();
  }

  /// Fetches and loads what is offered.
  void load(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::optional<msgs::GroupLibrary> wanted;
      std::shared_ptr<const SharedLibrary> before;
      {
        std::unique_lock<std::mutex> lock(mutex_);
        changed_.wait_for(lock, milliseconds(500),
                          [&] { return stop.stop_requested() || !is_settled(); });
        if (stop.stop_requested()) return;
        if (is_settled()) continue;
        wanted = wanted_;
        if (!libraries_.empty()) before = libraries_.front();
      }
      const auto same = find(wanted->digest);  // of the version before
      std::optional<Result<std::shared_ptr<const SharedLibrary>>> loaded;
      Status status = guarded("the library was not loaded", [&] {
        if (same) return;
        loaded.emplace(load_library(
            *wanted, before.get(), cache_,
            [&](const msgs::GetModelFile_Request& request) { return fetch(request, stop); },
            settings_.threads));
      });
      if (status.ok() && loaded) status = loaded->status();
      const std::lock_guard<std::mutex> lock(mutex_);
      if (status.ok()) {
        keep(same ? same : **loaded);
        problem_.clear();
        log(log_, LogLevel::info,
            concat("library ", wanted->digest, ": ", wanted->models.size(), " models are ready"));
      } else if (!stop.stop_requested()) {
        if (problem_ != status.message) log(log_, LogLevel::error, status.message);
        problem_ = status.message;
      }
      if (!status.ok()) {  // the mutex is free meanwhile
        retry_after_ = Clock::now() + kRetryFetch;
      }
    }
  }

  /// Nothing to do, or too early to try again.
  bool is_settled() const {
    if (!wanted_ || Clock::now() < retry_after_) return true;
    return !libraries_.empty() && libraries_.front()->offer.digest == wanted_->digest;
  }

  Result<msgs::GetModelFile_Response> fetch(const msgs::GetModelFile_Request& request,
                                            const std::stop_token& stop) {
    if (stop.stop_requested()) return unavailable("the worker is stopping");
    auto response = files_->call(request, kFetchTime);
    if (!response.ok() || response->success) return response;
    return wire::to_status(response->status);
  }

  void beat(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      (void)heartbeats_->publish(heartbeat());
      std::list<Share> ended;
      {
        std::unique_lock<std::mutex> lock(mutex_);
        changed_.wait_for(lock, kHeartbeat, [&] { return stop.stop_requested(); });
        for (auto share = shares_.begin(); share != shares_.end();) {
          const auto next = std::next(share);
          if (share->done) ended.splice(ended.end(), shares_, share);
          share = next;
        }
      }
      for (Share& share : ended) share.thread.join();
    }
  }

  msgs::GroupWorker heartbeat() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    msgs::GroupWorker message;
    message.worker = id_;
    message.name = settings_.name;
    message.version = BPA_VERSION;
    message.threads = static_cast<std::uint32_t>(resolve_num_threads(settings_.threads));
    message.searches = static_cast<std::uint32_t>(shares_.size());
    message.problem = problem_;
    for (const auto& library : libraries_) message.libraries.push_back(library->offer.digest);
    return message;
  }

  const WorkerSettings settings_;
  const Topics topics_;
  const LogHook log_;
  const std::uint64_t id_;
  const ModelCache cache_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<msgs::GroupLibrary> wanted_;
  Clock::time_point retry_after_{};
  std::string problem_;
  std::deque<std::shared_ptr<const SharedLibrary>> libraries_;  ///< The newest first.
  std::list<Share> shares_;

  std::mutex detector_mutex_;  ///< Guards the next three.
  std::shared_ptr<const Detector> detector_;
  std::string detector_library_;
  std::vector<std::string> detector_options_;

  std::optional<wire::Publisher<msgs::GroupAnswer>> answers_;
  std::optional<wire::Publisher<msgs::GroupWorker>> heartbeats_;
  std::optional<wire::ServiceClient<msgs::GetModelFile>> files_;
  std::optional<wire::Subscriber<msgs::GroupLibrary>> offers_;
  std::optional<wire::Subscriber<msgs::GroupTask>> tasks_;
  std::jthread loader_, beating_;
};

}  // namespace

Result<std::unique_ptr<Worker>> Worker::create(const wire::Participant& participant,
                                               const WorkerSettings& settings, LogHook log) {
  std::unique_ptr<Worker> worker;
  const Status status = guarded("the worker cannot start", [&] {
    worker = std::make_unique<RunningWorker>(participant, settings, std::move(log));
  });
  if (!status.ok()) return status;
  return worker;
}

}  // namespace bpa::server::group
