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
};

}  // namespace bpa::server
