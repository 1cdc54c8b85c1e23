// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "idl/wire/msg/builtin_interfaces.hpp"

namespace bpa::wire::builtin_interfaces {

/// Nanoseconds since the epoch.
inline std::int64_t to_ns(const Time& time) { return time.sec * 1'000'000'000LL + time.nanosec; }

/// The reverse. Times before 1970 round toward minus infinity.
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
