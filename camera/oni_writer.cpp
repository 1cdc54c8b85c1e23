// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>

#include "camera/oni_file.hpp"
#include "core/base/concat.hpp"

namespace bpa::camera {
namespace {

using namespace oni;

/// A record with these fields and, after them, `payload_bytes` of payload.
std::string record(RecordType type, std::uint32_t node, const std::string& fields = "",
                   std::uint64_t undo_position = 0, std::size_t payload_bytes = 0) {
  std::string bytes;
  put(bytes,
      RecordHeader{.type = type,
                   .node = node,
                   .field_bytes = static_cast<std::uint32_t>(sizeof(RecordHeader) + fields.size()),
                   .payload_bytes = static_cast<std::uint32_t>(payload_bytes),
                   .undo_position = undo_position});
  return bytes + fields;
}

/// OpenNI 1's number for an image's format, which players ask for, too.
std::uint64_t old_pixel_format(const OniStreamFormat& format) {
  if (format.kind == OniStreamInfo::Kind::depth) return 4;                // 16 bits of grey
  return format.frame_bytes >= 3 * format.width * format.height ? 1 : 3;  // rgb, 8 bits of grey
}

}  // namespace

Result<OniWriter> OniWriter::create(const std::string& path,
                                    const std::vector<OniStreamFormat>& streams, bool registered) {
  for (const OniStreamFormat& format : streams) {
    if (format.frame_bytes <= kMaxFrameBytes) continue;
    return Status(
        StatusCode::unsupported,
        concat("frames of ", format.frame_bytes,
               " bytes cannot be recorded; players of .oni files have room for ", kMaxFrameBytes));
  }
  OniWriter writer(path, std::ofstream(path, std::ios::binary | std::ios::trunc));
  if (!writer.file_) {
    return unavailable(path, " cannot be written: ", std::strerror(errno));
  }
  std::string header(kIdentity);
  header += {1, 0, 1, 0};  // version 1.0.1
  put(header, std::uint32_t{0});
  put(header, std::numeric_limits<std::uint64_t>::max());
  put(header, static_cast<std::uint32_t>(streams.size()));
  writer.append(header);
  // Players take all streams whose NODE_ADDED comes before the first STATE_READY.
  for (const OniStreamFormat& format : streams) {
    const auto node = static_cast<std::uint32_t>(writer.streams_.size() + 1);
    const Stream& stream = writer.streams_.emplace_back(Stream{format, node, writer.position_});
    writer.append(node_added(stream));
    writer.write_properties(stream, registered);
  }
  std::string begin;
  put(begin, std::numeric_limits<std::uint32_t>::max());
  put(begin, std::numeric_limits<std::uint64_t>::max());
  for (const Stream& s : writer.streams_) writer.append(record(RecordType::state_ready, s.node));
  for (const Stream& s : writer.streams_) {
    writer.append(record(RecordType::data_begin, s.node, begin));
  }
  if (Status status = writer.state(); !status.ok()) return status;
  return writer;
}

std::string OniWriter::node_added(const Stream& stream) {
  NodeFields node;
  node.kind = static_cast<std::uint32_t>(stream.format.kind);
  // Not known before the end, when the table is written.
  node.frames = stream.table_position > 0 ? static_cast<std::uint32_t>(stream.frames.size() - 1)
                                          : std::numeric_limits<std::uint32_t>::max();
  node.last_us = stream.frames.back().stamp_us;
  node.table_position = stream.table_position;
  std::string fields;
  put_text(fields, stream.format.kind == OniStreamInfo::Kind::depth ? "Depth" : "Image");
  put(fields, node);
  return record(RecordType::node_added, stream.node, fields);
}

void OniWriter::write_properties(const Stream& stream, bool registered) {
  const OniStreamFormat& format = stream.format;
  const auto add = [&](RecordType type, const char* name, const auto& value) {
    std::string fields;
    put_text(fields, name);
    put(fields, static_cast<std::uint32_t>(sizeof value));
    put(fields, value);
    append(record(type, stream.node, fields));
  };
  const auto add_number = [&](const char* name, std::uint64_t number) {
    add(RecordType::int_property, name, number);
  };
  add_number("oniRequiredFrameSize", format.frame_bytes);
  add_number("xnIsGenerating", 1);
  if (format.max_depth > 0) add_number("xnDeviceMaxDepth", format.max_depth);
  add_number("xnSupportedMapOutputModesCount", 1);
  const ModeValue mode{format.width, format.height, format.fps};
  add(RecordType::general_property, "xnSupportedMapOutputModes", mode);
  add(RecordType::general_property, kModeProperty, mode);
  add_number("xnPixelFormat", old_pixel_format(format));
  add_number("oniPixelFormat", format.pixel_format);
  add(RecordType::general_property, "xnFOV",
      std::array{format.horizontal_fov, format.vertical_fov});
  add(RecordType::general_property, "xnCropping", std::array<char, 12>{});
  add_number("xnMirror", format.mirrored ? 1 : 0);
  if (format.baseline_cm > 0) add(RecordType::real_property, "DCRCDIS", format.baseline_cm);
  if (format.kind == OniStreamInfo::Kind::depth) {
    add_number(kRegisteredProperty, registered ? 1 : 0);
  }
}

Status OniWriter::add(std::size_t index, std::int64_t stamp_us, const void* data,
                      std::size_t size) {
  Stream& stream = streams_[index];
  if (size != stream.format.frame_bytes) {
    return invalid_argument("a frame to record has ", size, " bytes; it must have ",
                            stream.format.frame_bytes);
  }
  if (first_us_ < 0) first_us_ = stamp_us;
  const auto stamp = static_cast<std::uint64_t>(std::max<std::int64_t>(0, stamp_us - first_us_));
  std::string fields;
  put(fields, FrameFields{stamp, static_cast<std::uint32_t>(stream.frames.size())});
  const std::uint64_t previous = stream.frames.back().position;
  stream.frames.push_back({stamp, 0, position_});
  append(record(RecordType::new_data, stream.node, fields, previous, size));
  file_.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  position_ += size;
  return state();
}

Status OniWriter::finish() {
  for (Stream& stream : streams_) {
    append(record(RecordType::node_removed, stream.node, "", stream.added_position));
    stream.table_position = position_;
    std::string table;
    for (const SeekEntry& frame : stream.frames) put(table, frame);
    append(record(RecordType::seek_table, stream.node, "", 0, table.size()) + table);
  }
  append(record(RecordType::end, 0));
  // Again, now with the number of frames.
  for (const Stream& stream : streams_) {
    file_.seekp(static_cast<std::streamoff>(stream.added_position));
    const std::string added = node_added(stream);
    file_.write(added.data(), static_cast<std::streamsize>(added.size()));
  }
  file_.close();
  return state();
}

std::uint32_t OniWriter::frames(std::size_t index) const {
  return index < streams_.size() ? static_cast<std::uint32_t>(streams_[index].frames.size() - 1)
                                 : 0;
}

void OniWriter::append(const std::string& bytes) {
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  position_ += bytes.size();
}

Status OniWriter::state() const {
  if (file_) return {};
  return unavailable(path_, " cannot be written any further: is the disk full?");
}

}  // namespace bpa::camera
