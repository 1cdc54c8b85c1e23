// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/status.hpp"
#include "core/io/new_file.hpp"

// The .oni files of OpenNI2: what is needed to check one and to write one. OpenNI2 plays them and
// trusts them: a damaged file makes its driver spin or crash. So every file is checked first.
//
// A file is a header of 24 bytes and records: a header of 28 bytes, fields and a payload, all
// little-endian without padding (OpenNI2: Source/Core/OniDataRecords.h). A stream is a node: its
// NODE_ADDED record, its properties, STATE_READY, DATA_BEGIN, one NEW_DATA for each frame, REMOVED
// and a table of where its frames lie. The file ends with END.

namespace bpa::camera {

/// The records, for oni_file.cpp.
namespace oni {

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
inline void put(std::string& bytes, const auto& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Takes a value off `bytes` at `offset`, which moves on; false past the end.
inline bool get(const std::string& bytes, std::size_t& offset, auto& value) {
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

}  // namespace oni

/// One stream of a recording.
struct OniStreamInfo {
  std::uint32_t node = 0;
  enum class Kind : std::uint32_t { depth = 2, color = 3, infrared = 5 } kind = Kind::depth;
  std::uint32_t frames = 0;
  std::uint32_t width = 0, height = 0, fps = 0;
};

struct OniFileInfo {
  std::vector<OniStreamInfo> streams;
  /// Whether the depth frames are registered to colour; only our own recordings say.
  enum class Registered { unknown, no, yes } registered = Registered::unknown;

  const OniStreamInfo* find(OniStreamInfo::Kind kind) const;
};

/// Walks over a whole recording without reading its frames. `not_found`; `corrupt` when it is no
/// recording, is truncated or has a record that cannot be (naming the place); `unsupported` when it
/// is older than OpenNI 1.5's.
Result<OniFileInfo> inspect_oni_file(const std::string& path);

/// What a stream's frames are, for writing.
struct OniStreamFormat {
  OniStreamInfo::Kind kind = OniStreamInfo::Kind::depth;
  std::uint32_t width = 0, height = 0, fps = 0;
  std::uint32_t pixel_format = 0;  ///< OniPixelFormat.
  std::uint32_t frame_bytes = 0;
  std::uint32_t max_depth = 0;  ///< In units of depth; for depth only.
  double horizontal_fov = 0;    ///< Radians.
  double vertical_fov = 0;
  bool mirrored = false;
  double baseline_cm = 0;  ///< Depth to colour camera, where the device says; else 0.
};

/// Writes a recording, uncompressed.
///
/// OpenNI2's own recorder has three faults. It counts each stream's time from that stream's first
/// frame, so simultaneous depth and colour get different stamps. It loses depths of the device's
/// maximum. Its thread takes a whole core. OniWriter keeps the stamps and every bit.
class OniWriter {
 public:
  /// Starts a file with these streams; `unavailable` when it cannot be written.
  static Result<OniWriter> create(const std::string& path,
                                  const std::vector<OniStreamFormat>& streams, bool registered);

  /// Adds a frame to stream `index`. Stamps of one stream grow; the first of all counts as 0.
  Status add(std::size_t index, std::int64_t stamp_us, const void* data, std::size_t size);
  /// Completes the file, which gets its name then: a recording that did not come to its end, also
  /// by a crash of the machine, is left as PATH.part, which the next of that name replaces.
  Status finish();

  const std::string& path() const { return path_; }
  std::uint64_t bytes() const { return file_.size(); }
  std::uint32_t frames(std::size_t index) const;

 private:
  struct Stream {
    OniStreamFormat format;
    std::uint32_t node = 0;
    std::uint64_t added_position = 0;
    std::uint64_t table_position = 0;                         ///< 0: not written yet.
    std::vector<oni::SeekEntry> frames = {oni::SeekEntry()};  ///< By number; they count from 1.
  };

  OniWriter(std::string path, io::NewFile file) : path_(std::move(path)), file_(std::move(file)) {}
  static std::string node_added(const Stream& stream);
  void write_properties(const Stream& stream, bool registered);
  void append(std::string_view bytes);
  Status state() const;

  std::string path_;
  io::NewFile file_;
  Status state_;  ///< The first thing that could not be written.
  std::int64_t first_us_ = -1;
  std::vector<Stream> streams_;
};

}  // namespace bpa::camera
