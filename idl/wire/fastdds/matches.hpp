// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>

#include "idl/wire/endpoint.hpp"

namespace bpa::wire::detail {

/// The remote endpoints that one of ours is matched with.
class Matches {
 public:
  void add(const Guid& peer);
  void remove(const Guid& peer);
  std::size_t count() const;
  bool wait_for(std::size_t count, std::chrono::milliseconds timeout) const;
  /// As RawWriter::is_matched_with.
  bool contains(const Guid& peer) const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::set<Guid> peers_;
};

}  // namespace bpa::wire::detail
