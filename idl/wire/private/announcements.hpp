// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

// Private to idl/wire: what participants say of themselves, in packets of RTPS (formal/22-04-01). A
// packet has a header of 20 bytes, then submessages; an announcement is one with parameters.

namespace bpa::wire::detail {

/// The first bytes of the GUIDs of all entities of a participant; in a packet those of its sender.
using GuidPrefix = std::array<std::uint8_t, 12>;
constexpr std::size_t kGuidPrefixAt = 8;

/// The seconds of a lease without an end.
constexpr std::uint32_t kEndlessLease = 0x7fffffff;

struct Announcement {
  std::uint32_t number = 0;  ///< Its sender counts them.
  bool leaves = false;
  std::size_t lease_at = 0;  ///< Where the packet has the 8 bytes of the lease; 0: it has none.
  bool little = true;        ///< The order of bytes of the lease.
  std::chrono::microseconds lease{};
};

/// What the sender says of itself. Announcements of others and what breaks a rule are left out.
std::vector<Announcement> announcements_in(const std::uint8_t* packet, std::size_t bytes);

/// In the packet that has the announcement, whose lease_at is not 0.
void make_lease_endless(std::uint8_t* packet, const Announcement& announcement);

/// The packet by which a participant leaves whose last announcement had the number before.
std::vector<std::uint8_t> departure(const GuidPrefix& prefix, std::uint32_t number);

}  // namespace bpa::wire::detail
