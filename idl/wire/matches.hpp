// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <set>

namespace bpa::wire {

/// A DDS GUID: 12 bytes of participant prefix, 4 of entity id. All zero: unknown.
using Guid = std::array<std::uint8_t, 16>;

namespace detail {

/// The remote endpoints that one of ours is matched with.
class Matches {
 public:
  /// Adds a peer if `change`, DDS's change of the number of matches, is positive; removes it if
  /// that is negative.
  void update(const Guid& peer, int change);
  std::size_t count() const;
  /// Whether there are `count` of them or more, or were before the time was over.
  bool wait_for(std::size_t count, std::chrono::milliseconds timeout) const;
  /// An entity id of zero stands for any endpoint of that participant.
  bool contains(const Guid& peer) const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::set<Guid> peers_;
};

}  // namespace detail
}  // namespace bpa::wire
