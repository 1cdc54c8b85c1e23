// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/log.hpp"

namespace bpa::server {

/// A text on one line, fit for a terminal: control characters and what is no UTF-8 as \n, \t, \xHH,
/// and no more than `most` bytes of it.
std::string printable(std::string_view text, std::size_t most = 1000);

/// What peers say ends up in the log. This keeps them from filling it: of one cause by one peer,
/// ten lines pass at once and then one in two seconds; of all together 200 and then 50 a second.
/// The cause is the text before the first colon without its digits. Messages below info are not
/// limited. Not locked.
class LogFilter {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// The line to log, printable; nothing when it is one too many. It ends with how many of its
  /// cause were left out before it.
  std::optional<std::string> pass(LogLevel level, const LogMessage& message, TimePoint now);

  /// A line for each cause of which lines were left out and none passed since, for 5 s.
  std::vector<std::string> left_out(TimePoint now);

 private:
  /// Gives tokens at a steady rate, and keeps some for a burst.
  class Bucket {
   public:
    Bucket(double burst, double per_second) : most_(burst), rate_(per_second), tokens_(burst) {}
    bool take(TimePoint now);

   private:
    double most_, rate_, tokens_;
    TimePoint last_{};
  };
  struct Cause {
    Bucket bucket{10, 0.5};
    std::uint64_t left_out = 0;
    TimePoint last{};  ///< When its last line came.
  };

  void forget_oldest();

  std::map<std::pair<std::string, std::string>, Cause> causes_;  ///< By cause and peer.
  Bucket all_{200, 50};
};

}  // namespace bpa::server
