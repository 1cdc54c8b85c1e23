// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/front.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "core/base/failure.hpp"
#include "core/base/guarded.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/subscriber.hpp"
#include "server/group/messages.hpp"
#include "server/group/remote_searches.hpp"
#include "server/group/session.hpp"
#include "server/group/topics.hpp"
#include "server/group/worker.hpp"

namespace bpa::server::group {
namespace {

namespace msgs = wire::bpa_msgs;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr auto kOfferPeriod = std::chrono::seconds(1);

class RunningFront : public Front {
 public:
  RunningFront(const wire::Participant& participant, const FrontSettings& settings, LogHook log)
      : settings_(settings),
        topics_(settings.group),
        participant_(participant),
        log_(log),
        links_(new Links{.front = new_session(),
                         .members = {participant, settings.group, std::move(log)},
                         .mailboxes = {},
                         .cost_mutex = {}}) {
    offer_.emplace(or_throw(
        wire::Publisher<msgs::GroupLibrary>::create(participant, topics_.library(), {qos()})));
    files_.emplace(or_throw(wire::ServiceServer<msgs::GetModelFile>::create(
        participant, topics_.model_files(),
        [this](msgs::GetModelFile_Request&& request, wire::ReplyToken<msgs::GetModelFile> token) {
          const auto library = this->library();
          msgs::GetModelFile_Response response;
          if (library) response = read_model_file(*library, request);
          (void)token.reply(response);
        })));
    answers_.emplace(or_throw(wire::Subscriber<msgs::GroupAnswer>::create(
        participant, topics_.answers(), {qos()},
        [this](msgs::GroupAnswer&& answer, const wire::SampleMeta&) {
          if (answer.front == links_->front) links_->mailboxes.deliver(std::move(answer));
        })));
    workers_.emplace(or_throw(wire::Subscriber<msgs::GroupWorker>::create(
        participant, topics_.workers(), {qos()},
        [this](msgs::GroupWorker&& said, const wire::SampleMeta&) {
          links_->members.heard(std::move(said));
        })));
    watch_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
  }

  ~RunningFront() override {
    watch_.request_stop();
    watch_.join();
    workers_.reset();
    answers_.reset();
    files_.reset();
  }

  void set_library(std::shared_ptr<const SharedLibrary> library) override {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      library_ = library;
    }
    if (!beside_) {
      beside_ = or_throw(Worker::create(participant_,
                                        {.group = settings_.group,
                                         .name = "beside the front",
                                         .cache = {},
                                         .threads = settings_.threads,
                                         .library = std::move(library)},
                                        log_));
    } else {
      beside_->set_library(std::move(library));
    }
    offer();
  }

  MakeSearches searches_for(std::shared_ptr<const SharedLibrary> library, const Frame& frame,
                            const DetectRequest& request, std::size_t waiting) override {
    return [this, library = std::move(library), &frame, &request, waiting](
               const std::vector<std::shared_ptr<const ObjectModel>>& models,
               const DetectorOptions& options, const SearchFacts& facts) {
      auto begin = begin_message(frame, request, options, facts, *library);
      begin.left_ms = request.budget_ms;
      return make_remote_searches(links_, ++searches_, library, models, std::move(begin), waiting);
    };
  }

  std::size_t ready_workers() const override {
    const auto library = this->library();
    if (!library) return 1;
    return std::max<std::size_t>(1, links_->members.ready(library->offer.digest).size());
  }

  std::vector<WorkerState> workers() const override {
    const auto library = this->library();
    return links_->members.states(library ? library->offer.digest : "");
  }

 private:
  std::shared_ptr<const SharedLibrary> library() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return library_;
  }

  /// All of the library where a worker may lack it, else that it is the same.
  void offer() {
    const auto library = this->library();
    if (!library) return;
    msgs::GroupLibrary message;
    message.digest = library->offer.digest;
    if (links_->members.any_lacks(message.digest)) message = library->offer;
    message.front = links_->front;
    (void)offer_->publish(message);
  }

  void watch(const std::stop_token& stop) {
    auto offered = Clock::now();
    while (!stop.stop_requested()) {
      links_->members.welcome();
      links_->members.look();
      if (Clock::now() - offered >= kOfferPeriod) {
        offer();
        offered = Clock::now();
      }
      std::this_thread::sleep_for(milliseconds(50));
    }
  }

  const FrontSettings settings_;
  const Topics topics_;
  const wire::Participant& participant_;
  const LogHook log_;
  const std::shared_ptr<Links> links_;
  std::atomic<std::uint64_t> searches_{0};
  mutable std::mutex mutex_;
  std::shared_ptr<const SharedLibrary> library_;
  std::optional<wire::Publisher<msgs::GroupLibrary>> offer_;
  std::optional<wire::ServiceServer<msgs::GetModelFile>> files_;
  std::optional<wire::Subscriber<msgs::GroupAnswer>> answers_;
  std::optional<wire::Subscriber<msgs::GroupWorker>> workers_;
  std::unique_ptr<Worker> beside_;
  std::jthread watch_;
};

}  // namespace

Result<std::unique_ptr<Front>> Front::create(const wire::Participant& participant,
                                             const FrontSettings& settings, LogHook log) {
  std::unique_ptr<Front> front;
  const Status status = guarded("the front cannot start", [&] {
    front = std::make_unique<RunningFront>(participant, settings, std::move(log));
  });
  if (!status.ok()) return status;
  return front;
}

}  // namespace bpa::server::group
