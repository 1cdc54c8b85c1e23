// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include "core/base/status.hpp"
#include "server/options.hpp"

namespace bpa::server {

/// The settings in force. Readers get a snapshot; changes come one at a time.
class Settings {
 public:
  using Snapshot = std::shared_ptr<const ServerOptions>;
  /// Applies changed settings. On failure they are not in force; the status has the reason.
  using Apply = std::function<Status(const ServerOptions& before, const ServerOptions& after)>;

  explicit Settings(const ServerOptions& options)
      : current_(std::make_shared<const ServerOptions>(options)) {}

  Snapshot get() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return current_;
  }

  /// Before the first change.
  void on_change(Apply apply) { apply_ = std::move(apply); }

  /// `edit` changes a copy; when that is legal and can be applied, it is the new snapshot.
  Status change(const std::function<Status(ServerOptions&)>& edit) {
    const std::lock_guard<std::mutex> change_lock(change_mutex_);
    const Snapshot before = get();
    auto after = std::make_shared<ServerOptions>(*before);
    if (Status status = edit(*after); !status.ok()) return status;
    if (Status status = validate(*after); !status.ok()) return status;
    if (apply_) {
      if (Status status = apply_(*before, *after); !status.ok()) return status;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    current_ = std::move(after);
    return {};
  }

 private:
  std::mutex change_mutex_;  ///< Held while a change is being made.
  Apply apply_;
  mutable std::mutex mutex_;
  Snapshot current_;
};

}  // namespace bpa::server
