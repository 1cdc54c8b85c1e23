// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "ros/frames.hpp"
#include "server/search_queue.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/stub_recognition.hpp"
#include "tests/support/wall_messages.hpp"

// A queue whose searches wait until the test lets them go on.

namespace bpa::server {

/// A detector that waits at a gate and says what it was asked.
class Gate {
 public:
  Result<SceneInterpretations> detect(const Frame& frame, const DetectRequest& request) {
    std::unique_lock<std::mutex> lock(mutex_);
    stamps_.push_back(frame.stamp_ns);
    fused_.push_back(frame.fused);
    priors_.push_back({});
    for (const bpa::PosePrior& prior : request.priors) priors_.back() += prior.model + " ";
    expected_.push_back({});
    for (const ExpectedPlacement& expected : request.expected) expected_.back() += expected.model;
    changed_.notify_all();
    changed_.wait(lock, [this] { return open_; });
    if (request.seed == 666) throw std::runtime_error("out of luck");
    SceneInterpretations result;
    result.stamp_ns = frame.stamp_ns;
    result.total_milliseconds = 1;
    Placement placement;
    placement.model = "found at " + std::to_string(frame.stamp_ns);
    result.interpretations = {{.placements = {placement}}, {.rank = 2, .placements = {}}};
    return result;
  }
  void open() {
    const std::lock_guard<std::mutex> lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  bool wait_for_started(std::size_t count) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, std::chrono::milliseconds(5000),
                             [&] { return stamps_.size() >= count; });
  }
  std::vector<std::int64_t> stamps() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return stamps_;
  }

  /// How many frames each that was searched is made of.
  std::vector<int> fused() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return fused_;
  }
  /// The models that each search was told to expect.
  std::vector<std::string> expected() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return expected_;
  }
  /// The models of the priors that each search was asked with.
  std::vector<std::string> priors() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return priors_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::int64_t> stamps_;
  std::vector<int> fused_;
  std::vector<std::string> priors_, expected_;
  bool open_ = false;
};

/// Searches by the gate.
class GatedRecognition : public support::StubRecognition {
 public:
  explicit GatedRecognition(Gate& gate, std::size_t at_once = 1) : gate_(gate), at_once_(at_once) {}
  std::size_t searches_at_once() const override { return at_once_; }
  Result<SceneInterpretations> detect(const Frame& frame,
                                      const DetectRequest& request) const override {
    return gate_.detect(frame, request);
  }

 private:
  Gate& gate_;
  const std::size_t at_once_;
};

/// Collects answers and lets the test wait for them.
class Answers {
 public:
  std::function<void(const DetectJob&, const Frame*, const Result<SceneInterpretations>&)>
  collector() {
    return [this](const DetectJob& job, const Frame*, const Result<SceneInterpretations>& result) {
      const std::lock_guard<std::mutex> lock(mutex_);
      statuses_.push_back(result.status());
      positions_.push_back(job.position);
      changed_.notify_all();
    };
  }
  std::vector<std::size_t> positions() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return positions_;
  }
  bool wait_for(std::size_t count) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, std::chrono::milliseconds(5000),
                             [&] { return statuses_.size() >= count; });
  }
  StatusCode code(std::size_t i) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return statuses_.at(i).code;
  }
  std::size_t size() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return statuses_.size();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Status> statuses_;
  std::vector<std::size_t> positions_;
};

class SearchQueueTest : public testing::Test {
 protected:
  std::unique_ptr<SearchQueue> make(SearchQueueOptions options = {}, std::size_t at_once = 1) {
    return std::make_unique<SearchQueue>(
        std::make_shared<GatedRecognition>(gate, at_once), options, statistics,
        [collect = streamed.collector()](const IncomingFrame&, const Frame* frame,
                                         const Result<SceneInterpretations>& result) {
          collect({}, frame, result);
        },
        LogHook(), clock);
  }
  static IncomingFrame frame(std::int64_t stamp, const std::string& camera = "c") {
    return {[stamp] { return ros::frame_from_message(support::wall_frame(stamp)); }, stamp, camera};
  }
  static IncomingFrame bad_frame() {
    return {
        [] { return ros::DecodedFrame(ros::RejectionCause::depth, invalid_argument("too short")); },
        0, "c"};
  }
  DetectJob job(bool with_frame, std::chrono::milliseconds time = std::chrono::milliseconds(5000),
                std::uint8_t client = 0, std::int64_t stamp = 77) {
    DetectJob job;
    if (with_frame) {
      job.decode = [stamp] { return ros::frame_from_message(support::wall_frame(stamp)); };
    }
    job.client[0] = client;
    job.timeout = time;
    job.done = answers.collector();
    return job;
  }

  std::shared_ptr<support::ManualClock> clock = std::make_shared<support::ManualClock>();
  Gate gate;
  Statistics statistics;
  Answers streamed;
  Answers answers;
};

}  // namespace bpa::server
