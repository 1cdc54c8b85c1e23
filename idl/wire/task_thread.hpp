// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "core/base/guarded.hpp"
#include "core/base/log.hpp"

namespace bpa::wire {

/// One thread that runs tasks at their time. What a DDS callback must not do itself goes here.
class TaskThread {
 public:
  using Clock = std::chrono::steady_clock;

  /// When more than `max_waiting` tasks wait, the one that is due first is dropped. `log` is told
  /// what a task throws.
  explicit TaskThread(LogHook log,
                      std::size_t max_waiting = std::numeric_limits<std::size_t>::max())
      : max_waiting_(max_waiting),
        thread_([state = state_, log = std::move(log)] { loop(*state, log); }) {}
  /// Drops what has not run yet and waits for what is running, unless that is the caller.
  ~TaskThread() {
    {
      const std::lock_guard<std::mutex> lock(state_->mutex);
      state_->stop = true;
    }
    state_->wake.notify_all();
    // A task may have been the last to hold what owns the thread.
    if (thread_.get_id() == std::this_thread::get_id()) {
      thread_.detach();
    } else {
      thread_.join();
    }
  }

  /// False when another task was dropped for this one.
  bool run_at(Clock::time_point time, std::function<void()> task) {
    decltype(State::tasks)::node_type dropped;  // destroyed after the lock
    const std::lock_guard<std::mutex> lock(state_->mutex);
    auto& tasks = state_->tasks;
    tasks.emplace(time, std::move(task));
    if (tasks.size() > max_waiting_) dropped = tasks.extract(tasks.begin());
    state_->wake.notify_all();
    return dropped.empty();
  }

 private:
  struct State {
    std::mutex mutex;
    std::condition_variable wake;
    std::multimap<Clock::time_point, std::function<void()>> tasks;
    bool stop = false;
  };

  static void loop(State& state, const LogHook& hook) {
    std::unique_lock<std::mutex> lock(state.mutex);
    while (!state.stop) {
      if (state.tasks.empty()) {
        state.wake.wait(lock);
        continue;
      }
      const Clock::time_point next = state.tasks.begin()->first;
      if (next > Clock::now()) {
        state.wake.wait_until(lock, next);
        continue;
      }
      std::function<void()> task = std::move(state.tasks.begin()->second);
      state.tasks.erase(state.tasks.begin());
      lock.unlock();
      const Status status = guarded("a task of DDS failed", task);
      task = nullptr;  // what it held may go here, not under the lock
      if (!status.ok()) log(hook, LogLevel::error, status.message);
      lock.lock();
    }
  }

  const std::size_t max_waiting_;
  const std::shared_ptr<State> state_ = std::make_shared<State>();
  std::thread thread_;
};

}  // namespace bpa::wire
