// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/worker.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <limits>
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
#include "core/pipeline/prepare_scene.hpp"
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

// A front that was silent for so long has gone; it says its library once a second.
constexpr auto kFrontGone = std::chrono::seconds(5);
constexpr auto kFetchTime = std::chrono::seconds(10);  // for one part of a file
constexpr auto kRetryFetch = std::chrono::seconds(2);
constexpr std::size_t kMaxSteps = 256;
constexpr std::size_t kMaxShares = 64;  // of all searches at once
constexpr std::size_t kLibraries = 2;   // kept: searches that run go on with the one before

/// What the front sends for one share.
class Steps {
 public:
  void push(msgs::GroupStep&& step) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (step.kind == msgs::GroupStep::kEnd) ended_ = true;
    // One that is left out is missed when its turn comes.
    if (!ended_ && steps_.size() < kMaxSteps) steps_.push_back(std::move(step));
    changed_.notify_all();
  }
  void end() {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }
  /// Waits for it; none: the search has ended, or its front has gone.
  std::optional<msgs::GroupStep> next() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return ended_ || !steps_.empty(); });
    if (ended_) return {};
    msgs::GroupStep step = std::move(steps_.front());
    steps_.pop_front();
    return step;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<msgs::GroupStep> steps_;
  bool ended_ = false;
};

/// Searches one share, on its own thread.
class ShareSearch {
 public:
  using Send = std::function<void(const msgs::GroupAnswer&)>;
  using FindLibrary = std::function<std::shared_ptr<const SharedLibrary>(const std::string&)>;

  ShareSearch(msgs::GroupStep&& begin, std::uint64_t worker, int threads, FindLibrary find,
              Send send)
      : find_(std::move(find)),
        send_(std::move(send)),
        threads_(threads),
        answer_from_(begin.answer_from),
        begin_(std::move(begin)) {
    answer_.front = begin_.front;
    answer_.search = begin_.search;
    answer_.share = begin_.share;
    answer_.worker = worker;
  }

  Steps& steps() { return steps_; }

  void run() {
    const Status status = guarded("the search of a share failed", [&] { return search(); });
    if (!status.ok()) refuse(status);
  }

 private:
  void refuse(const Status& status) {
    msgs::GroupAnswer answer = plain_answer();
    answer.step = std::max(step_, answer_from_);
    answer.status = server::to_message(status);
    send_(answer);
  }

  msgs::GroupAnswer plain_answer() const {
    msgs::GroupAnswer answer = answer_;
    answer.step = step_;
    answer.busy_ms = watch_.milliseconds();
    return answer;
  }

  /// None: nothing more is to be done, for the reason status_ if that is a failure.
  std::optional<msgs::GroupStep> next() {
    if (ended_) return {};
    std::optional<msgs::GroupStep> step = steps_.next();
    if (step && step->step != ++step_) return fail(corrupt("steps of a search were lost"));
    ended_ = !step;
    watch_ = Stopwatch();
    return step;
  }

  std::nullopt_t fail(Status status) {
    status_ = std::move(status);
    ended_ = true;
    return std::nullopt;
  }

  void send(msgs::GroupAnswer&& answer, const LocalSearches& searches) {
    if (ended_ || step_ < answer_from_) return;
    answer.late = searches.late();
    const SearchEffort effort = searches.effort();
    for (const auto& [name, count] : kEffortCounts) answer.effort.push_back(effort.*count);
    send_(answer);
  }

  /// Nothing passes where the search has ended, so that its stages end soon.
  Contest compete(const LocalSearches& searches, const std::vector<Claim>& claims, int most) {
    msgs::GroupAnswer answer = plain_answer();
    answer.competes = true;
    for (const Claim& claim : claims) answer.claims.push_back(to_message(claim));
    answer.most = most;
    send(std::move(answer), searches);
    std::optional<msgs::GroupStep> step = next();
    if (step && step->kind != msgs::GroupStep::kContest) {
      step = fail(corrupt("a search got a step of kind ", static_cast<int>(step->kind),
                          " where candidates compete"));
    }
    if (!step) return {std::numeric_limits<double>::infinity(), {}};
    Contest contest{step->threshold, {}};
    std::ranges::transform(step->claims, std::back_inserter(contest.claims), claim_from);
    return contest;
  }

  /// What was found since `sent`; after the final stages all.
  void send_found(const LocalSearches& searches, bool any_left, std::vector<std::size_t>& sent) {
    msgs::GroupAnswer answer = plain_answer();
    answer.exhausted = !any_left;
    for (std::size_t i = 0; i < sent.size(); ++i) {
      const Candidates& found = searches.found()[i];
      for (; sent[i] < found.size(); ++sent[i]) {
        answer.candidates.push_back(to_message(found[sent[i]]));
      }
    }
    send(std::move(answer), searches);
  }

  Status search() {
    const std::shared_ptr<const SharedLibrary> library = find_(begin_.library);
    if (!library) return not_found("this worker has no library ", begin_.library);
    const Deadline deadline = Deadline::after(begin_.left_ms);
    Result<ShareTask> task = task_of(std::move(begin_), *library);
    if (!task.ok()) return task.status();
    task->request.num_threads = task->facts.threads = threads_;
    const Result<SearchPlan> plan = plan_search(task->options, library->layers, task->facts);
    if (!plan.ok()) return plan.status();
    std::vector<StageTiming> timings;
    const SceneFeatures scene = prepare_scene(task->frame, *plan, deadline, timings);
    const SearchInputs inputs{scene, *plan, library->layers, task->request, task->models};
    LocalSearches* running = nullptr;
    LocalSearches searches(inputs, nullptr, [&](const std::vector<Claim>& claims, int most) {
      return compete(*running, claims, most);
    });
    running = &searches;
    std::vector<std::size_t> sent(task->models.size(), 0);
    const std::size_t pixels = scene.image.pixels.size();
    while (std::optional<msgs::GroupStep> step = next()) {
      const bool in_image = std::ranges::all_of(
          step->newly_certain, [&](std::uint32_t pixel) { return pixel < pixels; });
      if (!in_image) return corrupt("a step of a search names pixels outside of the image");
      if (Status status = run_step(*std::move(step), searches, sent); !status.ok()) return status;
    }
    return status_;
  }

  Status run_step(msgs::GroupStep&& step, LocalSearches& searches, std::vector<std::size_t>& sent) {
    const Deadline until = Deadline::after(step.left_ms);
    bool any_left = true;
    if (step.kind == msgs::GroupStep::kExpected) {
      searches.score_expected(until);
    } else if (step.kind == msgs::GroupStep::kRound) {
      any_left = searches.run_round({.number = static_cast<int>(step.round),
                                     .share = step.part,
                                     .hurried = step.hurried,
                                     .first_sample = step.first_sample,
                                     .newly_certain = std::move(step.newly_certain),
                                     .deadline = until});
    } else if (step.kind == msgs::GroupStep::kFinish) {
      searches.finish(
          {.share = step.part, .newly_certain = std::move(step.newly_certain), .deadline = until});
      std::ranges::fill(sent, 0);
    } else {
      return corrupt("a search got a step of kind ", static_cast<int>(step.kind));
    }
    send_found(searches, any_left, sent);
    return {};
  }

  const FindLibrary find_;
  const Send send_;
  const int threads_;
  const std::uint32_t answer_from_;
  msgs::GroupStep begin_;
  msgs::GroupAnswer answer_;  ///< What all answers have.
  std::uint32_t step_ = 0;
  Stopwatch watch_;     ///< Since the step came.
  bool ended_ = false;  ///< Nothing more is sent,
  Status status_;       ///< for this reason if it is a failure.
  Steps steps_;
};

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
