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
#include "server/group/remote_search.hpp"
#include "server/group/session.hpp"
#include "server/group/topics.hpp"

namespace bpa::server::group {
namespace {

namespace msgs = wire::bpa_msgs;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr auto kOfferPeriod = std::chrono::seconds(1);

class RunningFront : public Front {
 public:
  RunningFront(const wire::Participant& participant, const std::string& group, LogHook log)
      : topics_(group),
        links_(new Links{.front = new_session(),
                         .members = {participant, group, std::move(log)},
                         .mailboxes = {}}) {
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
      library_ = std::move(library);
    }
    offer();
  }

  RemoteSearch search_for(std::shared_ptr<const SharedLibrary> library, const Detector& detector,
                          const Frame& frame, const DetectRequest& request,
                          std::size_t waiting) override {
    return remote_search(links_,
                         {++searches_, std::move(library), detector, frame, request, waiting});
  }

  std::size_t ready_workers() const override {
    const auto library = this->library();
    return library ? links_->members.ready(library->offer.digest).size() : 0;
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

  const Topics topics_;
  const std::shared_ptr<Links> links_;
  std::atomic<std::uint64_t> searches_{0};
  mutable std::mutex mutex_;
  std::shared_ptr<const SharedLibrary> library_;
  std::optional<wire::Publisher<msgs::GroupLibrary>> offer_;
  std::optional<wire::ServiceServer<msgs::GetModelFile>> files_;
  std::optional<wire::Subscriber<msgs::GroupAnswer>> answers_;
  std::optional<wire::Subscriber<msgs::GroupWorker>> workers_;
  std::jthread watch_;
};

}  // namespace

Result<std::unique_ptr<Front>> Front::create(const wire::Participant& participant,
                                             const std::string& group, LogHook log) {
  std::unique_ptr<Front> front;
  const Status status = guarded("the front cannot start", [&] {
    front = std::make_unique<RunningFront>(participant, group, std::move(log));
  });
  if (!status.ok()) return status;
  return front;
}

}  // namespace bpa::server::group
