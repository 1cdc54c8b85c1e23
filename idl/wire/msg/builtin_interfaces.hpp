// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace bpa::wire::builtin_interfaces {

/// UTC unless the robot runs on simulated time.
struct Time {
  static constexpr const char* kType = "builtin_interfaces/msg/Time";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("sec", self.sec);
    visit("nanosec", self.nanosec);
  }
};

struct Duration {
  static constexpr const char* kType = "builtin_interfaces/msg/Duration";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("sec", self.sec);
    visit("nanosec", self.nanosec);
  }
};

/// Nanoseconds since the epoch, and back. Times before 1970 round toward minus infinity.
inline std::int64_t to_ns(const Time& time) { return time.sec * 1'000'000'000LL + time.nanosec; }

inline Time from_ns(std::int64_t ns) {
  std::int64_t sec = ns / 1'000'000'000LL;
  std::int64_t rest = ns % 1'000'000'000LL;
  if (rest < 0) {
    rest += 1'000'000'000LL;
    --sec;
  }
  return {static_cast<std::int32_t>(sec), static_cast<std::uint32_t>(rest)};
}

}  // namespace bpa::wire::builtin_interfaces
