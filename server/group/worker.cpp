// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/worker.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <tuple>
#include <utility>

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "core/base/guarded.hpp"
#include "core/base/parallel.hpp"
#include "core/io/file_bytes.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/status.hpp"
#include "idl/wire/subscriber.hpp"
#include "server/busy.hpp"
#include "server/group/session.hpp"
#include "server/group/share_search.hpp"
#include "server/group/topics.hpp"

namespace bpa::server::group {
namespace {

namespace msgs = wire::bpa_msgs;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// A front that was silent for so long has gone; it says its library once a second.
constexpr auto kFrontGone = std::chrono::seconds(5);
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
    if (settings.library) libraries_.push_back(settings.library);
    if (!settings.library) or_throw(io::make_folder(settings.cache), "the workers' cache");
    answers_.emplace(or_throw(
        wire::Publisher<msgs::GroupAnswer>::create(participant, topics_.answers(), {qos()})));
    heartbeats_.emplace(or_throw(
        wire::Publisher<msgs::GroupWorker>::create(participant, topics_.workers(), {qos()})));
    if (!settings.library) {
      files_.emplace(or_throw(
          wire::ServiceClient<msgs::GetModelFile>::create(participant, topics_.model_files())));
      offers_.emplace(or_throw(wire::Subscriber<msgs::GroupLibrary>::create(
          participant, topics_.library(), {qos()},
          [this](msgs::GroupLibrary&& offer, const wire::SampleMeta&) {
            take(std::move(offer));
          })));
      loader_ = std::jthread([this](const std::stop_token& stop) { load(stop); });
    }
    steps_.emplace(or_throw(wire::Subscriber<msgs::GroupStep>::create(
        participant, topics_.steps(id_), {qos()},
        [this](msgs::GroupStep&& step, const wire::SampleMeta&) { take(std::move(step)); })));
    beating_ = std::jthread([this](const std::stop_token& stop) { beat(stop); });
  }

  ~RunningWorker() override {
    steps_.reset();
    offers_.reset();
    for (std::jthread* thread : {&beating_, &loader_}) {
      thread->request_stop();
      changed_.notify_all();
      if (thread->joinable()) thread->join();
    }
    for (const auto& [key, share] : shares_) share->search.steps().end();
    for (const auto& [key, share] : shares_) share->thread.join();
  }

  void set_library(std::shared_ptr<const SharedLibrary> library) override {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      keep(std::move(library));
    }
    (void)heartbeats_->publish(heartbeat());
  }

  Status health(double limit_s) const override {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& [key, share] : shares_) {
      const auto work = share->busy.work();
      if (!work || work->seconds <= limit_s) continue;
      return Status(StatusCode::internal, concat(work->name, " has not ended for ",
                                                 fixed(work->seconds, 1), " s: it hangs"));
    }
    return {};
  }

 private:
  using Key = std::tuple<std::uint64_t, std::uint64_t, std::uint32_t>;  // front, search, share

  struct Share {
    template <class... Arguments>
    explicit Share(Arguments&&... arguments) : search(std::forward<Arguments>(arguments)...) {}

    ShareSearch search;
    Busy busy;
    std::atomic<bool> done{false};
    std::thread thread;
  };

  static Key key_of(const msgs::GroupStep& step) { return {step.front, step.search, step.share}; }

  // On a DDS thread.
  void take(msgs::GroupStep&& step) {
    std::vector<std::unique_ptr<Share>> ended;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      heard_[step.front] = Clock::now();
      const Key key = key_of(step);
      if (const auto found = shares_.find(key); found != shares_.end()) {
        found->second->search.steps().push(std::move(step));
      } else if (step.kind == msgs::GroupStep::kBegin && shares_.size() < kMaxShares) {
        start(key, std::move(step));
      }
      ended = take_ended();
    }
    for (const auto& share : ended) share->thread.join();
  }

  void start(const Key& key, msgs::GroupStep&& begin) {
    auto share = std::make_unique<Share>(
        std::move(begin), id_, settings_.threads,
        [this](const std::string& digest) { return find(digest); },
        [this](const msgs::GroupAnswer& answer) { (void)answers_->publish(answer); });
    Share* const raw = share.get();
    share->thread = std::thread([this, raw] {
      raw->busy.begin("the search of a share");
      raw->search.run();
      raw->busy.end();
      raw->done = true;
    });
    shares_.emplace(key, std::move(share));
  }

  /// Those whose threads have ended, or will at once. The caller holds the mutex.
  std::vector<std::unique_ptr<Share>> take_ended() {
    std::vector<std::unique_ptr<Share>> ended;
    for (auto share = shares_.begin(); share != shares_.end();) {
      if (share->second->done) {
        ended.push_back(std::move(share->second));
        share = shares_.erase(share);
      } else {
        ++share;
      }
    }
    return ended;
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
    heard_[offer.front] = Clock::now();
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
      std::vector<std::unique_ptr<Share>> ended;
      {
        std::unique_lock<std::mutex> lock(mutex_);
        end_orphans();
        ended = take_ended();
        changed_.wait_for(lock, kHeartbeat, [&] { return stop.stop_requested(); });
      }
      for (const auto& share : ended) share->thread.join();
    }
  }

  /// Ends searches of fronts that have gone. The caller holds the mutex.
  void end_orphans() {
    if (settings_.library) return;  // beside its front
    std::erase_if(heard_,
                  [](const auto& entry) { return Clock::now() - entry.second > kFrontGone; });
    for (const auto& [key, share] : shares_) {
      if (!heard_.contains(std::get<0>(key))) share->search.steps().end();
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
    message.reserve = settings_.library != nullptr;
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
  std::map<std::uint64_t, Clock::time_point> heard_;            ///< Of fronts.
  std::map<Key, std::unique_ptr<Share>> shares_;

  std::optional<wire::Publisher<msgs::GroupAnswer>> answers_;
  std::optional<wire::Publisher<msgs::GroupWorker>> heartbeats_;
  std::optional<wire::ServiceClient<msgs::GetModelFile>> files_;
  std::optional<wire::Subscriber<msgs::GroupLibrary>> offers_;
  std::optional<wire::Subscriber<msgs::GroupStep>> steps_;
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
