// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>

#include <bpa/wire/endpoint.hpp>

namespace bpa::wire::detail {

/// The remote endpoints that one of ours is matched with.
class Matches {
 public:
  void add(const Guid& peer);
  void remove(const Guid& peer);
  std::size_t count() const;
  bool wait_for(std::size_t count, std::chrono::milliseconds timeout) const;
  /// As RawWriter::matched_for; of several, the one that came last.
  std::optional<std::chrono::milliseconds> matched_for(const Guid& peer) const;

 private:
  using Clock = std::chrono::steady_clock;

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::map<Guid, Clock::time_point> since_;
};

}  // namespace bpa::wire::detail
