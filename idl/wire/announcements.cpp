// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/private/announcements.hpp"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <optional>

namespace bpa::wire::detail {

namespace {

using Byte = std::uint8_t;

constexpr std::size_t kHeader = 20;
constexpr Byte kData = 0x15;
constexpr Byte kLittleEndian = 1, kInlineQos = 2, kPayload = 4;
constexpr std::array<Byte, 4> kAnnouncer{0, 1, 0, 0xc2}, kAnnouncementReader{0, 1, 0, 0xc7};
constexpr std::array<Byte, 4> kParticipant{0, 0, 1, 0xc1};
constexpr std::uint32_t kSentinel = 1, kLease = 2, kGuid = 0x50, kKeyHash = 0x70, kStatus = 0x71;

/// A packet up to the end of a submessage, in its byte order. What is outside reads as 0.
struct Submessage {
  const Byte* data = nullptr;
  std::size_t size = 0;
  bool little = true;

  std::uint32_t number(std::size_t at, std::size_t bytes) const {
    std::uint32_t value = 0;
    if (at > size || size - at < bytes) return 0;
    for (std::size_t i = 0; i < bytes; ++i) {
      value = value << 8 | data[at + (little ? bytes - 1 - i : i)];
    }
    return value;
  }
  std::uint32_t u16(std::size_t at) const { return number(at, 2); }
  std::uint32_t u32(std::size_t at) const { return number(at, 4); }
  bool equals(std::size_t at, const Byte* other, std::size_t bytes) const {
    return at <= size && size - at >= bytes && std::memcmp(data + at, other, bytes) == 0;
  }
};

/// Calls `found(id, where, size)` for each parameter of the list at `at`; gives back its end.
template <class Found>
std::size_t for_each_parameter(const Submessage& view, std::size_t at, Found found) {
  while (at + 4 <= view.size) {
    const std::uint32_t id = view.u16(at), size = view.u16(at + 2);
    at += 4;
    if (id == kSentinel) return at;
    if (size > view.size - at) break;
    found(id, at, size);
    at += size;
  }
  return view.size;
}

/// The announcement in a DATA submessage that ends at the end of `view`, if there is one.
std::optional<Announcement> announcement(Submessage view, std::size_t at) {
  const Byte flags = view.data[at + 1];
  view.little = (flags & kLittleEndian) != 0;
  const std::uint32_t to_parameters = view.u16(at + 6);
  if (!view.equals(at + 12, kAnnouncer.data(), 4) || to_parameters < 16) return {};
  Announcement result;
  result.number = view.u32(at + 20);
  std::size_t next = at + 8 + to_parameters;
  if ((flags & kInlineQos) != 0) {
    next =
        for_each_parameter(view, next, [&](std::uint32_t id, std::size_t where, std::size_t size) {
          if (id == kStatus && size == 4) result.leaves = (view.data[where + 3] & 3) != 0;
        });
  }
  if ((flags & kPayload) == 0 || next + 4 > view.size) return result;
  view.little = result.little = (view.data[next + 1] & 1) != 0;
  bool own = false;  // a discovery server announces others
  for_each_parameter(view, next + 4, [&](std::uint32_t id, std::size_t where, std::size_t size) {
    if (id == kGuid) own = view.equals(where, view.data + kGuidPrefixAt, 12);
    if (id != kLease || size != 8) return;
    result.lease_at = where;
    const std::uint64_t fraction = std::uint64_t{view.u32(where + 4)} * 1'000'000 >> 32;
    const auto seconds = static_cast<std::int32_t>(view.u32(where));
    result.lease = std::chrono::seconds(seconds) + std::chrono::microseconds(fraction);
  });
  if (!own) return {};
  return result;
}

void put(Byte* data, std::uint32_t value, bool little) {
  for (int i = 0; i < 4; ++i) {
    data[little ? i : 3 - i] = static_cast<Byte>(value >> (8 * i));
  }
}

}  // namespace

std::vector<Announcement> announcements_in(const Byte* data, std::size_t bytes) {
  std::vector<Announcement> result;
  if (bytes < kHeader || std::memcmp(data, "RTPS", 4) != 0) return result;
  for (std::size_t at = kHeader; at + 4 <= bytes;) {
    Submessage view{data, bytes, (data[at + 1] & kLittleEndian) != 0};
    const std::size_t size = view.u16(at + 2);
    if (size != 0) view.size = std::min(at + 4 + size, bytes);  // 0: to the end
    if (data[at] == kData && view.size - at >= 24) {
      if (auto found = announcement(view, at)) result.push_back(*found);
    }
    if (size == 0) break;
    at += 4 + (size + 3) / 4 * 4;
  }
  return result;
}

void make_lease_endless(Byte* packet, const Announcement& announcement) {
  put(packet + announcement.lease_at, kEndlessLease, announcement.little);
  put(packet + announcement.lease_at + 4, 0xffffffff, announcement.little);
}

std::vector<Byte> departure(const GuidPrefix& prefix, std::uint32_t number) {
  std::vector<Byte> bytes{'R', 'T', 'P', 'S', 2, 3, 1, 15};
  const auto add = [&](const auto& more) { bytes.insert(bytes.end(), more.begin(), more.end()); };
  const auto add_all = [&](std::initializer_list<Byte> more) { add(more); };
  add(prefix);
  add_all({kData, kLittleEndian | kInlineQos, 52, 0, 0, 0, 16, 0});
  add(kAnnouncementReader);
  add(kAnnouncer);
  add_all({0, 0, 0, 0, 0, 0, 0, 0});
  put(bytes.data() + bytes.size() - 4, number, true);
  add_all({kKeyHash, 0, 16, 0});
  add(prefix);
  add(kParticipant);
  add_all({kStatus, 0, 4, 0, 0, 0, 0, 3, kSentinel, 0, 0, 0});
  return bytes;
}

}  // namespace bpa::wire::detail
