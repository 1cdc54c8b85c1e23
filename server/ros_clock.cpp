// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/ros_clock.hpp"

#include <algorithm>
#include <utility>

#include "idl/wire/qos.hpp"
#include "idl/wire/time.hpp"

namespace bpa::server {
namespace {

constexpr auto kSimulatedPoll = std::chrono::milliseconds(20);
constexpr auto kLongestStandstill = std::chrono::seconds(5);

using SteadyClock = std::chrono::steady_clock;
using ClockMessage = wire::rosgraph_msgs::Clock;

}  // namespace

Status RosClock::simulate(const wire::Participant& participant, bool simulated) {
  if (simulated == !is_real()) return {};
  std::optional<wire::Subscriber<ClockMessage>> subscriber;
  if (simulated) {
    auto made = wire::Subscriber<ClockMessage>::create(
        participant, "/clock", {.qos = wire::qos::clock()},
        [this](ClockMessage&& message, const wire::SampleMeta&) { take(message); });
    if (!made.ok()) return made.status();
    subscriber.emplace(std::move(made).value());
  }
  std::unique_lock<std::mutex> lock(mutex_);
  const TimePoint real = SteadyClock::now();
  if (simulated) {
    now_ = real + shift_;
    moved_ = real;
  } else {
    shift_ = now_ - real;
  }
  stamp_ns_.reset();
  simulated_ = simulated;
  subscriber_.swap(subscriber);
  lock.unlock();  // the old one waits for its callback, which takes the lock
  return {};
}

void RosClock::take(const ClockMessage& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::int64_t stamp_ns = to_ns(message.clock);
  if (stamp_ns_ != stamp_ns) moved_ = SteadyClock::now();
  const std::int64_t passed_ns = stamp_ns_ ? stamp_ns - *stamp_ns_ : 0;
  if (simulated_) now_ += std::chrono::nanoseconds(std::max<std::int64_t>(passed_ns, 0));
  stamp_ns_ = stamp_ns;
}

WaitableClock::TimePoint RosClock::now() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return simulated_ ? now_ : SteadyClock::now() + shift_;
}

std::int64_t RosClock::stamp_ns() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return simulated_ ? stamp_ns_.value_or(0) : unix_time_ns();
}

bool RosClock::is_real() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return !simulated_;
}

void RosClock::wait_until(std::condition_variable& wake, std::unique_lock<std::mutex>& lock,
                          TimePoint until) {
  const auto left = until - now();
  wake.wait_for(lock, is_real() ? left : std::min<TimePoint::duration>(left, kSimulatedPoll));
}

bool RosClock::stands_still() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return simulated_ && SteadyClock::now() - moved_ >= kLongestStandstill;
}

SourceReport RosClock::report() const {
  SourceReport report;
  report.name = "clock";
  report.hardware_id = "/clock";
  report.message = "the time is that of /clock";
  if (!stands_still()) return report;
  report.level = SourceReport::kWarn;
  report.message =
      "use_sim_time is true and the time on /clock stands still: is the simulation running?";
  return report;
}

}  // namespace bpa::server
