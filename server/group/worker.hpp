// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/participant.hpp"

namespace bpa::server::group {

struct WorkerSettings {
  std::string group = "bpa";
  std::string name;   ///< For people.
  std::string cache;  ///< Folder of fetched models.
  int threads = 0;    ///< 0: one per core.
};

/// Takes part in the searches of a group, from create() until it is destroyed: fetches the front's
/// library, says that it is there, and searches the shares that it is given.
class Worker {
 public:
  /// `invalid_argument` for a bad name, `unavailable` when DDS cannot start or the cache cannot be
  /// written. The participant outlives it.
  static Result<std::unique_ptr<Worker>> create(const wire::Participant& participant,
                                                const WorkerSettings& settings, LogHook log);
  virtual ~Worker() = default;

  /// What has not returned for so many seconds; ok where nothing hangs.
  virtual Status health(double limit_s) const = 0;
};

}  // namespace bpa::server::group
