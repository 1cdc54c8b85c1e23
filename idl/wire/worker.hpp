// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <thread>

namespace bpa::wire::detail {

/// One thread that runs things at their time. What a DDS callback must not do itself goes here.
class Worker {
 public:
  using Clock = std::chrono::steady_clock;

  Worker();
  /// Drops what has not run yet and waits for what is running, unless that is the caller.
  ~Worker();
  void run_at(Clock::time_point time, std::function<void()> task);

 private:
  struct State;
  static void loop(State& state);

  std::shared_ptr<State> state_;
  std::thread thread_;
};

}  // namespace bpa::wire::detail
