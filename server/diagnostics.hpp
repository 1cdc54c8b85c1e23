// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "idl/wire/msg/bpa_msgs.hpp"
#include "idl/wire/msg/diagnostic_msgs.hpp"
#include "server/options.hpp"
#include "server/sources/frame_source.hpp"
#include "server/statistics.hpp"

// What /diagnostics says, from what the server counts.

namespace bpa::server {

/// Events a second over the last 10 s.
struct Rates {
  double frames_received = 0;
  double frames_processed = 0;
  double frames_dropped = 0;
  double frames_bad = 0;  ///< Rejected or failed.
  double requests_served = 0;
  double requests_refused = 0;
  double requests_lost = 0;  ///< Malformed, lost by DDS, or their reply was dropped.
};

/// Turns counters that are read now and then into rates.
class RateMeter {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  void add(TimePoint now, const Counts& counts);
  /// Zero before the second reading.
  Rates rates() const;

 private:
  std::deque<std::pair<TimePoint, Counts>> readings_;
};

/// All that diagnostics are made of.
struct Health {
  std::string node;  ///< Its full name.
  wire::bpa_msgs::GetStatus_Response status;
  Rates rates;
  std::vector<std::pair<std::string, std::uint64_t>> drops;  ///< Cause and count.
  std::vector<SourceReport> sources;
  std::vector<wire::diagnostic_msgs::KeyValue> fusion = {};  ///< What became of frames combined.
  std::vector<std::pair<std::string, double>> effort = {};   ///< Medians of a search's counts.
  RequestLosses losses = {};
  std::string hang = {};  ///< What hangs; empty: nothing does.
};

/// Frames that no result was made of, by cause.
std::vector<std::pair<std::string, std::uint64_t>> drop_counts(const Statistics& statistics);
/// What became of frames that are combined; empty while each is searched by itself.
std::vector<wire::diagnostic_msgs::KeyValue> fusion_values(const Statistics& statistics,
                                                           int fuse_frames);
/// That depth images had no partner, and why.
std::string sync_complaint(const ros::SyncCounts& sync, const InputOptions& input);
/// The losses by name; those refused are counted with others.
std::vector<wire::diagnostic_msgs::KeyValue> loss_values(const RequestLosses& losses);

/// One status each for detection, drops, queue and models, and one for every source. Names read
/// "NODE: detection", as diagnostic_updater makes them.
wire::diagnostic_msgs::DiagnosticArray diagnostics_message(const Health& health,
                                                           std::int64_t stamp_ns);

}  // namespace bpa::server
