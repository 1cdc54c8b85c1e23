// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/status.hpp"
#include "core/base/stopwatch.hpp"
#include "core/pipeline/model_searches.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "server/convert/results.hpp"
#include "server/group/library.hpp"

namespace bpa::server::group {

constexpr std::size_t kMaxSteps = 256;  ///< That wait.

/// What the front sends for one share.
class Steps {
 public:
  void push(wire::bpa_msgs::GroupStep&& step) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (step.kind == wire::bpa_msgs::GroupStep::kEnd) ended_ = true;
    // One that is left out is missed when its turn comes.
    if (!ended_ && steps_.size() < kMaxSteps) steps_.push_back(std::move(step));
    changed_.notify_all();
  }
  void end() {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }
  /// Waits for it; none: the search has ended, or its front has gone.
  std::optional<wire::bpa_msgs::GroupStep> next() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return ended_ || !steps_.empty(); });
    if (ended_) return {};
    wire::bpa_msgs::GroupStep step = std::move(steps_.front());
    steps_.pop_front();
    return step;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<wire::bpa_msgs::GroupStep> steps_;
  bool ended_ = false;
};

/// Searches one share: the worker's part of a search that a front plans. On its own thread.
class ShareSearch {
 public:
  using Send = std::function<void(const wire::bpa_msgs::GroupAnswer&)>;
  using FindLibrary = std::function<std::shared_ptr<const SharedLibrary>(const std::string&)>;

  ShareSearch(wire::bpa_msgs::GroupStep&& begin, std::uint64_t worker, int threads,
              FindLibrary find, Send send);

  Steps& steps() { return steps_; }
  /// Returns when the search has ended, or its front has gone.
  void run();

 private:
  void refuse(const Status& status);
  wire::bpa_msgs::GroupAnswer plain_answer() const;
  std::optional<wire::bpa_msgs::GroupStep> next();
  std::nullopt_t fail(Status status);
  void send(wire::bpa_msgs::GroupAnswer&& answer, const LocalSearches& searches);
  detect::Contest compete(const LocalSearches& searches, const std::vector<detect::Claim>& claims,
                          int most);
  void send_found(const LocalSearches& searches, std::vector<std::size_t>& sent);
  Status search();
  Status run_step(wire::bpa_msgs::GroupStep&& step, const Models& models, LocalSearches& searches,
                  std::vector<std::size_t>& sent);

  const FindLibrary find_;
  const Send send_;
  const int threads_;
  const std::uint32_t answer_from_;
  wire::bpa_msgs::GroupStep begin_;
  wire::bpa_msgs::GroupAnswer answer_;  ///< What all answers have.
  std::uint32_t step_ = 0;
  Stopwatch watch_;     ///< Since the step came.
  bool ended_ = false;  ///< Nothing more is sent,
  Status status_;       ///< for this reason if it is a failure.
  Steps steps_;
};

}  // namespace bpa::server::group
