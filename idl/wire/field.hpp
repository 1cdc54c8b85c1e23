// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

// How a message describes itself. Every message is a plain struct with
//
//   static constexpr const char* kType = "std_msgs/msg/Header";
//   static constexpr const char* kTypeHash = "RIHS01_<64 hex digits>";  // REP 2011
//   template <class Self, class Visitor>
//   static void fields(Self& self, Visitor&& visit) {
//     visit("stamp", self.stamp);
//     visit("frame_id", self.frame_id);
//   }
//
// in the order of its .idl. idl/generate.py writes these structs at build time. Encoding and
// decoding read the list of fields. The C++ types of IDL's: bool boolean, std::byte octet,
// [u]intN_t [u]intN, float, double, std::string string, std::vector sequence, std::array a fixed
// array. A nested message is a struct of this kind.

namespace bpa::wire {

/// The bound of a string or sequence, such as `string<256>` or `sequence<T, 1>`; 0 is unbounded.
struct Bound {
  std::size_t max = 0;
};

/// Bytes of another owner. Stands for sequence<uint8> in messages that are published without a
/// copy. Valid as long as the memory it points to.
struct ByteView {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;

  bool empty() const { return size == 0; }
};

/// A type as ROS 2's service get_type_description tells of it.
struct TypeDescriptionText {
  const char* name;  ///< "pkg/msg/Name"
  const char* hash;
  const char* json;    ///< A type_description_interfaces/msg/TypeDescription.
  const char* source;  ///< The text of the .idl file.
};

/// A type of messages as recordings tell of it.
struct MessageDefinition {
  const char* name;  ///< "pkg/msg/Name"
  const char* hash;
  const char* text;  ///< Its .msg file and those of all types in it; MCAP's "ros2msg".
};

}  // namespace bpa::wire
