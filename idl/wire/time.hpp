// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

#include "idl/wire/msg/builtin_interfaces.hpp"

namespace bpa::wire::builtin_interfaces {

/// Nanoseconds since the epoch.
inline std::int64_t to_ns(const Time& time) { return time.sec * 1'000'000'000LL + time.nanosec; }

/// The reverse. Times before 1970 round toward minus infinity.
inline Time from_ns(std::int64_t ns) {
  const std::chrono::nanoseconds time(ns);
  const auto whole = std::chrono::floor<std::chrono::seconds>(time);
  return {static_cast<std::int32_t>(whole.count()),
          static_cast<std::uint32_t>((time - whole).count())};
}

}  // namespace bpa::wire::builtin_interfaces
