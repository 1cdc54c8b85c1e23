// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace bpa::sdk {

/// Runs calls one after the other on a thread of its own, so that a slow one never holds up DDS.
/// When more than 100 wait, the oldest goes.
class CallbackThread {
 public:
  CallbackThread();
  /// Waits for the call that runs now; forgets the others. Not to be destroyed by a call.
  ~CallbackThread();
  CallbackThread(const CallbackThread&) = delete;
  CallbackThread& operator=(const CallbackThread&) = delete;

  void post(std::function<void()> call);

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> calls_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace bpa::sdk
