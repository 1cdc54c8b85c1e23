// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/participant.hpp"
#include "server/diagnostics.hpp"
#include "server/log_relay.hpp"
#include "server/options.hpp"
#include "server/output.hpp"
#include "server/recognition.hpp"
#include "server/result_publisher.hpp"
#include "server/services/services.hpp"
#include "server/settings.hpp"
#include "server/sources/frame_source.hpp"
#include "server/sources/topic_source.hpp"
#include "server/statistics.hpp"
#include "server/worker.hpp"

namespace bpa::server {

using Clock = std::chrono::steady_clock;

/// The daemon without its main(): takes frames from topics, has them searched, publishes what was
/// found and answers services, from create() until it is destroyed. A frame or request that breaks
/// a rule is reported and forgotten.
class Server {
 public:
  /// Fails with `invalid_argument` on options that break a rule, `unavailable` when DDS cannot
  /// start.
  static Result<std::unique_ptr<Server>> create(const ServerOptions& options,
                                                std::shared_ptr<Recognition> recognition,
                                                LogHook log);
  ~Server();

  Counts counts() const { return statistics_.counts(); }
  SyncCounts sync_counts() const { return topics_->sync_counts(); }

 private:
  Server(const ServerOptions& options, std::shared_ptr<Recognition> recognition, LogHook log);
  Status start();
  Status join();
  Status start_sources(const ServerOptions& options);
  Status offer_services();
  Status apply(const ServerOptions& before, const ServerOptions& after);
  void on_result(const IncomingFrame& incoming, const Frame* frame,
                 const Result<SceneInterpretations>& result);
  void log_failure(const Status& status);
  wire::bpa_msgs::GetStatus_Response status() const;
  std::vector<wire::diagnostic_msgs::KeyValue> details() const;
  std::vector<std::pair<std::string, std::uint64_t>> drops() const;
  std::vector<wire::diagnostic_msgs::KeyValue> fusion() const;
  std::vector<SourceReport> source_reports() const;
  void report(const std::stop_token& stop);
  void report_losses();

  Settings settings_;
  const std::shared_ptr<Recognition> recognition_;
  LogRelay relay_;
  const LogHook log_;
  const Clock::time_point started_ = Clock::now();
  Statistics statistics_;
  std::mutex failure_mutex_;
  std::string last_failure_;       ///< Text of the last failed frame, and
  Clock::time_point last_logged_;  ///< when one was logged: the same is said once in 10 s.
  std::uint64_t losses_reported_ = 0;

  // In the order in which they come up; destroyed from the last to the first, so that nothing calls
  // into what is gone.
  std::optional<wire::Participant> participant_;
  std::unique_ptr<ResultPublisher> publisher_;
  Output<wire::diagnostic_msgs::DiagnosticArray> diagnostics_;
  std::unique_ptr<Worker> worker_;
  std::vector<std::unique_ptr<FrameSource>> sources_;
  TopicSource* topics_ = nullptr;  ///< One of them.
  std::optional<ServiceSet> services_;
  std::optional<ServiceSet> parameters_;
  std::jthread reporter_;
};

}  // namespace bpa::server
