// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "core/pipeline/detector.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "server/group/library.hpp"
#include "server/group/members.hpp"

namespace bpa::server::group {

/// The answers that reach the front, by search.
class Mailboxes {
 public:
  struct Box {
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<wire::bpa_msgs::GroupAnswer> answers;
  };

  /// It takes answers as long as it lives.
  std::shared_ptr<Box> open(std::uint64_t search) {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::erase_if(boxes_, [](const auto& entry) { return entry.second.expired(); });
    auto box = std::make_shared<Box>();
    boxes_[search] = box;
    return box;
  }
  void deliver(wire::bpa_msgs::GroupAnswer&& answer) {
    std::shared_ptr<Box> box;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      const auto found = boxes_.find(answer.search);
      if (found != boxes_.end()) box = found->second.lock();
    }
    if (!box) return;
    const std::lock_guard<std::mutex> lock(box->mutex);
    box->answers.push_back(std::move(answer));
    box->changed.notify_all();
  }

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, std::weak_ptr<Box>> boxes_;
};

/// What is common to all searches of a front.
struct Links {
  std::uint64_t front;
  Members members;
  Mailboxes mailboxes;
};

/// What one search is about. References outlive the search.
struct RemoteTask {
  std::uint64_t number;  ///< Counts the searches of this front.
  std::shared_ptr<const SharedLibrary> library;
  const Detector& detector;  ///< Of that library: searches what no worker can.
  const Frame& frame;
  const DetectRequest& request;
  std::size_t waiting;  ///< Frames that wait for a search.
};

/// Splits the models of a frame over the workers, and joins what they find. Models of a worker that
/// is lost, or that breaks a rule, are given to another. Without a time budget the answer has all
/// models.
RemoteSearch remote_search(std::shared_ptr<Links> links, RemoteTask task);

}  // namespace bpa::server::group
