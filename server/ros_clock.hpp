// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>

#include "core/base/clock.hpp"
#include "idl/wire/msg/rosgraph_msgs.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/subscriber.hpp"
#include "server/sources/frame_source.hpp"

namespace bpa::server {

/// ROS time: that of this machine or, while it is simulated, what comes on /clock. Stamps are those
/// of /clock, 0 before the first. now() grows by what passes there; a jump back adds nothing, so a
/// recording may be played in a loop. Thread-safe.
class RosClock : public WaitableClock {
 public:
  /// Listens to /clock from now on, or no longer. Fails as Subscriber::create() does, and is then
  /// as before.
  Status simulate(const wire::Participant& participant, bool simulated);

  TimePoint now() const override;
  std::int64_t stamp_ns() const override;
  bool is_real() const override;
  /// While it is simulated it may return early, every 20 ms.
  void wait_until(std::condition_variable& wake, std::unique_lock<std::mutex>& lock,
                  TimePoint until) override;

  /// Whether it is simulated and has stood still for 5 s of this machine's time.
  bool stands_still() const;
  /// For /diagnostics, while it is simulated.
  SourceReport report() const;

 private:
  void take(const wire::rosgraph_msgs::Clock& message);

  mutable std::mutex mutex_;
  bool simulated_ = false;
  std::chrono::nanoseconds shift_{0};     ///< From steady_clock to now() while it is not simulated.
  TimePoint now_;                         ///< While it is simulated.
  std::optional<std::int64_t> stamp_ns_;  ///< Of the last message on /clock.
  TimePoint moved_;                       ///< When it moved last, by steady_clock.
  std::optional<wire::Subscriber<wire::rosgraph_msgs::Clock>> subscriber_;  ///< Last: calls back.
};

}  // namespace bpa::server
