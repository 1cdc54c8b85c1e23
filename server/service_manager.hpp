// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "core/base/status.hpp"

namespace bpa::server {

/// Tells systemd how this process is, as sd_notify(3) specifies: datagrams to the socket that
/// NOTIFY_SOCKET names. Without that variable nothing is told.
class ServiceManager {
 public:
  /// Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  ServiceManager();

  /// Sends lines such as "READY=1\nSTATUS=...". `unavailable` when nobody takes them.
  Status tell(const std::string& lines) const;

  /// WATCHDOG=1 is due more often than this; 0: never.
  std::chrono::microseconds watchdog_time() const { return watchdog_time_; }

 private:
  std::string socket_;  ///< A path; '@' stands for the NUL of an abstract one.
  std::chrono::microseconds watchdog_time_{0};
};

}  // namespace bpa::server
