// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

// The records of .oni files, for oni_file.cpp and oni_writer.cpp.

namespace bpa::camera::oni {

inline constexpr char kIdentity[] = "NI10";
inline constexpr std::size_t kFileHeaderBytes = 24;
/// What OpenNI2's player has room for.
inline constexpr std::uint32_t kMaxFrameBytes = 1600 * 1200 * 3;
inline constexpr std::uint32_t kMaxFieldBytes = 1U << 20U;
inline constexpr std::uint32_t kUncompressed = 0x454E4F4E;  // "NONE"
inline constexpr const char* kRegisteredProperty = "bpaRegistered";
inline constexpr const char* kModeProperty = "xnMapOutputMode";

enum class RecordType : std::uint32_t {
  int_property = 0x03,
  real_property = 0x04,
  general_property = 0x06,
  node_removed = 0x07,
  data_begin = 0x08,
  state_ready = 0x09,
  new_data = 0x0A,
  end = 0x0B,
  node_added = 0x0D,
  seek_table = 0x0E,
};
inline constexpr RecordType kFirstType{0x02}, kLastType = RecordType::seek_table;

// As they lie in a file; the project runs on little-endian machines only.
#pragma pack(push, 1)
struct RecordHeader {
  static constexpr std::uint32_t kMagic = 0x0052494E;  // "NIR"
  std::uint32_t magic = kMagic;
  RecordType type{};
  std::uint32_t node = 0;
  std::uint32_t field_bytes = 0;  ///< Of this header and the fields.
  std::uint32_t payload_bytes = 0;
  std::uint64_t undo_position = 0;
};
/// Fields of node_added after the name.
struct NodeFields {
  std::uint32_t kind = 0;
  std::uint32_t codec = kUncompressed;
  std::uint32_t frames = 0;
  std::uint64_t first_us = 0;
  std::uint64_t last_us = 0;
  std::uint64_t table_position = 0;
};
/// Fields of new_data.
struct FrameFields {
  std::uint64_t stamp_us = 0;
  std::uint32_t number = 0;  ///< From 1.
};
/// One entry of the payload of seek_table.
struct SeekEntry {
  std::uint64_t stamp_us = 0;
  std::uint32_t configuration = 0;
  std::uint64_t position = 0;
};
/// The value of kModeProperty.
struct ModeValue {
  std::uint32_t width = 0, height = 0, fps = 0;
};
#pragma pack(pop)

/// Appends a value as it lies in memory.
template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Takes a value off `bytes` at `offset`, which moves on; false past the end.
template <class T>
bool get(const std::string& bytes, std::size_t& offset, T& value) {
  if (bytes.size() < offset + sizeof value) return false;
  std::memcpy(static_cast<void*>(&value), bytes.data() + offset, sizeof value);
  offset += sizeof value;
  return true;
}

/// A text field: its length with the final zero, and the text with it.
inline void put_text(std::string& bytes, const std::string& text) {
  put(bytes, static_cast<std::uint32_t>(text.size() + 1));
  bytes.append(text.c_str(), text.size() + 1);
}

inline bool get_text(const std::string& bytes, std::size_t& offset, std::string& text) {
  std::uint32_t size = 0;
  if (!get(bytes, offset, size) || size == 0 || bytes.size() - offset < size) return false;
  text.assign(bytes, offset, size - 1);
  offset += size;
  return true;
}

}  // namespace bpa::camera::oni
