// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/claims.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "core/base/guarded.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/subscriber.hpp"
#include "server/group/session.hpp"
#include "server/group/topics.hpp"

namespace bpa::server::group {
namespace {

namespace msgs = wire::bpa_msgs;
using Clock = std::chrono::steady_clock;

// A front that was silent for so long is gone: four heartbeats. Clients wait for the next one.
constexpr std::chrono::milliseconds kFrontSilence(800);
constexpr std::chrono::milliseconds kListen(1000);
constexpr std::size_t kMaxFronts = 64;

class Taking : public Claims {
 public:
  Taking(const wire::Participant& participant, const std::string& group, const std::string& name,
         int strength, LogHook log)
      : log_(std::move(log)), own_{new_session(), name, strength, false} {
    const std::string topic = Topics(group).fronts();
    claims_.emplace(
        or_throw(wire::Publisher<msgs::GroupFront>::create(participant, topic, {qos()})));
    others_said_.emplace(or_throw(wire::Subscriber<msgs::GroupFront>::create(
        participant, topic, {qos()},
        [this](msgs::GroupFront&& said, const wire::SampleMeta&) { heard(std::move(said)); })));
    beating_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        say();
        std::this_thread::sleep_for(kHeartbeat);
      }
    });
  }

  ~Taking() override {
    others_said_.reset();
    beating_.request_stop();
    beating_.join();
  }

  bool is_to_serve() const override {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto now = Clock::now();
    if (now - started_ < kListen) return false;
    std::vector<FrontClaim> others;
    for (const auto& [id, other] : others_) {
      if (now - other.heard < kFrontSilence) others.push_back(other.claim);
    }
    return group::is_to_serve(own_, others);
  }

  void set_serves(bool serves) override {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      own_.serves = serves;
    }
    say();
  }

 private:
  struct Other {
    FrontClaim claim;
    Clock::time_point heard;
  };

  void say() {
    FrontClaim own;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      own = own_;
    }
    (void)claims_->publish(msgs::GroupFront{
        .front = own.front, .name = own.name, .strength = own.strength, .serves = own.serves});
  }

  void heard(msgs::GroupFront&& said) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (said.front == own_.front) return;
    const auto now = Clock::now();
    if (said.serves && own_.serves && warned_of_.insert(said.front).second) {
      log(log_, LogLevel::warning,
          concat("two fronts of the group serve: ", own_.name, " (strength ", own_.strength,
                 ") and ", said.name, " (strength ", said.strength,
                 "); were they cut off from each other? One of them stops now"));
    }
    std::erase_if(others_,
                  [&](const auto& entry) { return now - entry.second.heard > 10 * kFrontSilence; });
    if (others_.size() >= kMaxFronts && !others_.contains(said.front)) return;
    others_[said.front] = {{said.front, std::move(said.name), said.strength, said.serves}, now};
  }

  const LogHook log_;
  const Clock::time_point started_ = Clock::now();
  mutable std::mutex mutex_;
  FrontClaim own_;
  std::map<std::uint64_t, Other> others_;
  std::set<std::uint64_t> warned_of_;
  std::optional<wire::Publisher<msgs::GroupFront>> claims_;
  std::optional<wire::Subscriber<msgs::GroupFront>> others_said_;
  std::jthread beating_;
};

}  // namespace

bool is_to_serve(const FrontClaim& own, const std::vector<FrontClaim>& others) {
  return std::ranges::none_of(others, [&](const FrontClaim& other) {
    if (other.strength != own.strength) {
      return other.strength > own.strength && (other.serves || !own.serves);
    }
    return other.serves == own.serves ? other.front < own.front : other.serves;
  });
}

Result<std::unique_ptr<Claims>> Claims::create(const wire::Participant& participant,
                                               const std::string& group, const std::string& name,
                                               int strength, LogHook log) {
  std::unique_ptr<Claims> claims;
  const Status status = guarded("the front cannot take part in its group", [&] {
    claims = std::make_unique<Taking>(participant, group, name, strength, std::move(log));
  });
  if (!status.ok()) return status;
  return claims;
}

}  // namespace bpa::server::group
