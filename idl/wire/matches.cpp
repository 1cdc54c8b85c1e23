// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/matches.hpp"

#include <algorithm>

namespace bpa::wire::detail {

void Matches::update(const Guid& peer, int change) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (change > 0) peers_.insert(peer);
    if (change < 0) peers_.erase(peer);
  }
  changed_.notify_all();
}

std::size_t Matches::count() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return peers_.size();
}

bool Matches::wait_for(std::size_t count, std::chrono::milliseconds timeout) const {
  std::unique_lock<std::mutex> lock(mutex_);
  return changed_.wait_for(lock, timeout, [&] { return peers_.size() >= count; });
}

bool Matches::contains(const Guid& peer) const {
  constexpr std::ptrdiff_t kPrefix = 12;
  const bool any_entity =
      std::all_of(peer.begin() + kPrefix, peer.end(), [](std::uint8_t byte) { return byte == 0; });
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!any_entity) return peers_.count(peer) != 0;
  return std::any_of(peers_.begin(), peers_.end(), [&peer](const Guid& guid) {
    return std::equal(guid.begin(), guid.begin() + kPrefix, peer.begin());
  });
}

}  // namespace bpa::wire::detail
