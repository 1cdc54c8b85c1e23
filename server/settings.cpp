// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/settings.hpp"

namespace bpa::server {

Status Settings::change(const std::function<Status(ServerOptions&)>& edit) {
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

}  // namespace bpa::server
