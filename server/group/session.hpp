// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <random>

// How members of a group are told apart, and when one counts as lost.

namespace bpa::server::group {

/// A random number for one start of a program; never 0.
inline std::uint64_t new_session() {
  std::random_device device;
  const std::uint64_t high = device(), low = device();
  return high << 32 | low | 1;
}

constexpr std::chrono::milliseconds kHeartbeat(200);
/// A member that was silent for so long is lost: six heartbeats. By hand.
constexpr std::chrono::milliseconds kSilence(1200);

}  // namespace bpa::server::group
