// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <bpa/wire/fastdds/matches.hpp>

namespace bpa::wire::detail {

void Matches::add(const Guid& peer) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    since_.emplace(peer, Clock::now());
  }
  changed_.notify_all();
}

void Matches::remove(const Guid& peer) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    since_.erase(peer);
  }
  changed_.notify_all();
}

std::size_t Matches::count() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return since_.size();
}

bool Matches::wait_for(std::size_t count, std::chrono::milliseconds timeout) const {
  std::unique_lock<std::mutex> lock(mutex_);
  return changed_.wait_for(lock, timeout, [&] { return since_.size() >= count; });
}

std::optional<std::chrono::milliseconds> Matches::matched_for(const Guid& peer) const {
  constexpr std::ptrdiff_t kPrefix = 12;
  const bool any_entity =
      std::all_of(peer.begin() + kPrefix, peer.end(), [](std::uint8_t byte) { return byte == 0; });
  const std::ptrdiff_t compared = any_entity ? kPrefix : 16;
  std::optional<Clock::time_point> newest;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& [guid, since] : since_) {
    const bool same = std::equal(guid.begin(), guid.begin() + compared, peer.begin());
    if (same && (!newest || since > *newest)) newest = since;
  }
  if (!newest) return std::nullopt;
  return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - *newest);
}

}  // namespace bpa::wire::detail
