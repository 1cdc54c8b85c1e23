// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

// How a message describes itself. Every message is a plain struct with
//
//   static constexpr const char* kType = "std_msgs/msg/Header";
//   template <class Self, class Visitor>
//   static void fields(Self& self, Visitor&& visit) {
//     visit("stamp", self.stamp);
//     visit("frame_id", self.frame_id);
//   }
//
// in the order of its .idl. Encoding, decoding, the type hash and the tests that compare the
// structs with the .idl files all read that one list. The C++ types stand for IDL's as follows:
// bool boolean, std::byte octet, [u]intN_t [u]intN, float, double, std::string string, std::vector
// sequence, std::array a fixed array, a struct of this kind a nested message.

namespace bpa::wire {

/// The bound of a string or sequence, such as `string<256>` or `sequence<T, 1>`; 0 is unbounded.
struct Bound {
  std::size_t max = 0;
};

/// Bytes that belong to somebody else; stands for sequence<uint8> in messages that are sent without
/// copying them first. Valid as long as what it points to.
struct ByteView {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;

  bool empty() const { return size == 0; }
};

/// The member that IDL puts into a struct without fields: one byte on the wire.
inline constexpr const char* kEmptyStructField = "structure_needs_at_least_one_member";

}  // namespace bpa::wire
