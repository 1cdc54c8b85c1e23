// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "server/options.hpp"
#include "server/recognition.hpp"

namespace bpa::server {

/// The daemon without its main(): takes frames from topics, has them searched, publishes what was
/// found and answers services, from create() until it is destroyed. A frame or request that breaks
/// a rule is reported and forgotten.
class Server {
 public:
  /// `invalid_argument` for options that break a rule, `unavailable` when DDS cannot start.
  static Result<std::unique_ptr<Server>> create(const ServerOptions& options,
                                                std::shared_ptr<Recognition> recognition,
                                                LogHook log);
  virtual ~Server() = default;

  /// Whether all threads do their work: `internal` names what has not returned for
  /// detection.hang_s. From any thread.
  virtual Status health() const = 0;
  /// For a server that hangs, before its process ends: says why, answers requests that wait, ends
  /// recordings and withdraws the services. It must not be used or destroyed after this.
  virtual void abandon(const Status& why) = 0;
  /// Before it is destroyed, where another server has its place: requests that wait or come stay
  /// without an answer, as the other one answers them.
  virtual void leave_to_another() {}
};

}  // namespace bpa::server
