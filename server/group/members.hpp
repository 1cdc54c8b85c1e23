// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/log.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/publisher.hpp"
#include "server/group/topics.hpp"
#include "server/recognition.hpp"

namespace bpa::server::group {

using TaskPublisher = wire::Publisher<wire::bpa_msgs::GroupTask>;

/// What the front knows of one worker.
struct Member {
  wire::bpa_msgs::GroupWorker said;
  std::chrono::steady_clock::time_point heard{};
  std::shared_ptr<TaskPublisher> tasks;
  bool lost = false;  ///< Silent, as was logged.
  /// Since when its heartbeats say that it searches nothing; of no meaning while it does.
  std::chrono::steady_clock::time_point resting{};
  double ms_a_model = 0;             ///< 0: not measured yet.
  std::set<std::uint64_t> searches;  ///< Of this front.
};

/// The workers of a front's group. Thread-safe.
class Members {
 public:
  Members(const wire::Participant& participant, std::string group, LogHook log)
      : participant_(participant), topics_(std::move(group)), log_(std::move(log)) {}

  /// A heartbeat.
  void heard(wire::bpa_msgs::GroupWorker&& said);

  /// Opens the topics of new workers. Not on a DDS thread, where that waits for itself.
  void welcome();

  /// Notes who was silent for too long.
  void look();

  /// Whether it is silent, or was never heard.
  bool is_lost(std::uint64_t worker) const;
  /// Whether it has said for as long as the silence of a lost one that it searches nothing: a task
  /// that was sent before is lost.
  bool rests(std::uint64_t worker) const;

  /// Ids of workers that can search this library, those with the fewest searches first.
  std::vector<std::uint64_t> ready(const std::string& library) const;

  /// How many searches these take part in now.
  std::size_t searches(const std::vector<std::uint64_t>& workers) const;

  /// Its measured time for a model of a search; before that the mean of others, or 1 of no unit.
  double ms_a_model(std::uint64_t worker) const;

  /// Of one more search.
  void measured(std::uint64_t worker, double ms_a_model);

  /// Asks it to take part in a search.
  void send(std::uint64_t worker, const wire::bpa_msgs::GroupTask& task);
  /// It takes part no more.
  void done(std::uint64_t worker, std::uint64_t search);

  /// Whether a worker that is there has not got this library.
  bool any_lacks(const std::string& library) const;

  /// For people.
  std::string name_of(std::uint64_t worker) const;

  std::vector<WorkerState> states(const std::string& library) const;

  const LogHook& hook() const { return log_; }

 private:
  static bool can_search(const Member& member, const std::string& library);

  const wire::Participant& participant_;
  const Topics topics_;
  const LogHook log_;
  mutable std::mutex mutex_;
  std::map<std::uint64_t, Member> members_;
};

}  // namespace bpa::server::group
