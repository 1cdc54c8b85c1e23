// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "server/web/feed.hpp"
#include "server/web/http.hpp"

namespace bpa::server::web {

/// What a viewer waits for.
struct Poll {
  std::string viewer;
  std::uint64_t sequence = 0;  ///< Of the feed, that it knows.
  std::uint64_t result = 0;    ///< The last result that it knows.
  bool tracks = false;
  Responder respond;
};

/// Viewers that wait for news. Each is answered as soon as there is any, at most `rate_hz` times a
/// second, and after 2 s in any case: a viewer that does not read its answer does not ask again,
/// and so costs nothing. One thread of its own.
class Polls {
 public:
  using Clock = Feed::Clock;
  static constexpr std::chrono::seconds kLongestWait{2};

  /// `make_answer` gives the body for a viewer; it runs on the thread of this class.
  Polls(Feed& feed, std::function<double()> rate_hz,
        std::function<std::string(const Poll&)> make_answer);
  ~Polls();
  Polls(const Polls&) = delete;
  Polls& operator=(const Polls&) = delete;

  /// A viewer that waits already is answered at once: it has one seat.
  void add(Poll poll);

 private:
  struct Waiting {
    Poll poll;
    Clock::time_point earliest, latest;
  };
  void run(const std::stop_token& stop);
  std::vector<Poll> take_due(Clock::time_point now);
  Clock::time_point next_due(Clock::time_point now) const;

  Feed& feed_;
  const std::function<double()> rate_hz_;
  const std::function<std::string(const Poll&)> make_answer_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::map<std::string, Waiting> waiting_;             ///< By viewer.
  std::map<std::string, Clock::time_point> answered_;  ///< When each was answered last.
  bool news_ = false;
  std::jthread thread_;  ///< Last: uses what stands above.
};

}  // namespace bpa::server::web
