// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <thread>

#include "core/base/clock.hpp"
#include "core/base/log.hpp"
#include "idl/wire/msg/rcl_interfaces.hpp"
#include "idl/wire/participant.hpp"
#include "server/output.hpp"

namespace bpa::server {

/// Passes messages of a level or above through a LogFilter to the terminal's hook and, once there
/// is a participant, to /rosout. DDS threads log while they hold locks of DDS. So a separate thread
/// feeds /rosout through a bounded queue; messages that do not fit are counted and reported.
class LogRelay {
 public:
  /// `sink` may be empty.
  LogRelay(LogHook sink, LogLevel least, std::shared_ptr<WaitableClock> clock = steady_clock());
  LogRelay(const LogRelay&) = delete;
  LogRelay& operator=(const LogRelay&) = delete;

  /// May be called at any time, even after the relay was destroyed.
  LogHook hook() const;
  void set_level(LogLevel least);
  /// Says how many messages the filter left out of floods that have ended. Call it now and then.
  void report_left_out();

  /// Starts to publish, earlier messages first. Throws a Failure.
  void connect(const wire::Participant& participant, const std::string& topic);

 private:
  struct State;
  void run(const std::stop_token& stop);

  const std::shared_ptr<State> state_;
  std::string logger_;  ///< The node's name, as loggers are called in ROS 2.
  Output<wire::rcl_interfaces::Log> rosout_;
  std::jthread thread_;  ///< Last: uses what stands above.
};

/// "debug", "info", "warning" (also "warn") or "error" (also "fatal"); info for any other word.
LogLevel log_level(const std::string& word);

}  // namespace bpa::server
