// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/src/callback_thread.hpp"

#include <utility>

namespace bpa::sdk {

CallbackThread::CallbackThread() : thread_([this] { run(); }) {}

CallbackThread::~CallbackThread() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void CallbackThread::post(std::function<void()> call) {
  constexpr std::size_t kMaxWaiting = 100;
  std::function<void()> displaced;  // destroyed outside the lock
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    calls_.push_back(std::move(call));
    if (calls_.size() > kMaxWaiting) {
      displaced = std::move(calls_.front());
      calls_.pop_front();
    }
  }
  wake_.notify_one();
}

void CallbackThread::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stopping_ || !calls_.empty(); });
    if (stopping_) return;
    const std::function<void()> call = std::move(calls_.front());
    calls_.pop_front();
    lock.unlock();
    call();
    lock.lock();
  }
}

}  // namespace bpa::sdk
