// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

#include "core/base/concat.hpp"
#include "core/base/status.hpp"
#include "idl/wire/endpoint.hpp"
#include "server/busy.hpp"
#include "server/fair_queue.hpp"

namespace bpa::server {

/// Handles requests on a thread of its own, clients in turn: one that takes long delays others of
/// its kind, not what DDS receives. Neither function of an errand may throw.
class RequestThread {
 public:
  static constexpr std::size_t kMaxWaitingRequests = 1024;

  explicit RequestThread(std::size_t capacity = kMaxWaitingRequests)
      : capacity_(capacity), thread_([this](const std::stop_token& stop) { run(stop); }) {}

  void push(const wire::Guid& client, Errand errand) {
    std::unique_lock<std::mutex> lock(mutex_);
    const bool full = queue_.size() >= capacity_;
    std::optional<Errand> displaced = full ? queue_.displace_for(client) : std::nullopt;
    const bool taken = !full || displaced;
    if (taken) queue_.push(client, std::move(errand));
    lock.unlock();
    changed_.notify_one();
    if (!full) return;
    const auto& refuse = taken ? displaced->refuse : errand.refuse;
    refuse(Status(StatusCode::busy,
                  concat(capacity_, " requests wait, as many as may; try again later")));
  }

  const Busy& busy() const { return busy_; }

 private:
  void run(const std::stop_token& stop) {
    std::unique_lock<std::mutex> lock(mutex_);
    while (changed_.wait(lock, stop, [this] { return !queue_.empty(); }) &&
           !stop.stop_requested()) {
      const std::optional<Errand> errand = queue_.pop();
      busy_.begin("a request");
      lock.unlock();
      errand->handle();
      lock.lock();
      busy_.end();
    }
  }

  const std::size_t capacity_;
  Busy busy_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  FairQueue<wire::Guid, Errand> queue_;
  std::jthread thread_;  ///< Last: uses what stands above.
};

}  // namespace bpa::server
