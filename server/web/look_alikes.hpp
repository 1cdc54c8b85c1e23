// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/guarded.hpp"
#include "core/doctor/library_check.hpp"
#include "server/recognition.hpp"

namespace bpa::server::web {

/// Compares all models of the library with each other, when a viewer asks, on one thread: it takes
/// seconds for each pair of equal size. Thread-safe.
class LookAlikes {
 public:
  explicit LookAlikes(std::shared_ptr<const Recognition> recognition)
      : recognition_(std::move(recognition)) {}

  struct Answer {
    bool running = false;
    Status status;              ///< Why the comparison failed.
    doctor::Findings findings;  ///< None while it runs.
  };

  /// Starts a comparison unless there is one of the library as it is now.
  Answer ask() {
    const int version = recognition_->version();
    const std::lock_guard<std::mutex> lock(mutex_);
    if (version != version_ && !answer_.running) {
      version_ = version;
      answer_ = {true, {}, {}};
      thread_ = std::jthread([this] { compare(); });  // the one before has ended
    }
    return answer_;
  }

 private:
  void compare() {
    Answer answer;
    answer.status = guarded("the models cannot be compared", [&] {
      std::vector<ModelSource> sources;
      for (const auto& model : recognition_->models()) sources.push_back(*model);
      answer.findings = doctor::check_look_alikes(sources, true, 1);
    });
    const std::lock_guard<std::mutex> lock(mutex_);
    answer_ = std::move(answer);
  }

  const std::shared_ptr<const Recognition> recognition_;
  std::mutex mutex_;
  int version_ = 0;  ///< Of the library that answer_ is about; 0: none.
  Answer answer_;
  std::jthread thread_;  ///< Last: uses what stands above.
};

}  // namespace bpa::server::web
