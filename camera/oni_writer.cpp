// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <limits>

#include "camera/oni_file.hpp"
#include "camera/oni_records.hpp"

namespace bpa::camera {
namespace {

using namespace oni;

/// A record with these fields and, after them, `payload_bytes` of payload.
std::string record(RecordType type, std::size_t stream, const std::string& fields = "",
                   std::uint64_t undo_position = 0, std::size_t payload_bytes = 0) {
  RecordHeader header;
  header.type = static_cast<std::uint32_t>(type);
  header.node = static_cast<std::uint32_t>(stream + 1);
  header.field_bytes = static_cast<std::uint32_t>(kRecordHeaderBytes + fields.size());
  header.payload_bytes = static_cast<std::uint32_t>(payload_bytes);
  header.undo_position = undo_position;
  std::string bytes;
  put_header(bytes, header);
  return bytes + fields;
}

std::string property(RecordType type, std::size_t stream, const char* name,
                     const std::string& value) {
  std::string fields;
  put_text(fields, name);
  put(fields, static_cast<std::uint32_t>(value.size()));
  return record(type, stream, fields + value);
}

std::string number_property(std::size_t stream, const char* name, std::uint64_t number) {
  std::string value;
  put(value, number);
  return property(RecordType::int_property, stream, name, value);
}

std::string real_property(std::size_t stream, const char* name, double number) {
  std::string value;
  put(value, number);
  return property(RecordType::real_property, stream, name, value);
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
    return Status(StatusCode::unsupported,
                  "frames of " + std::to_string(format.frame_bytes) +
                      " bytes cannot be recorded; players of .oni files have room for " +
                      std::to_string(kMaxFrameBytes));
  }
  OniWriter writer(path, std::ofstream(path, std::ios::binary | std::ios::trunc));
  if (!writer.file_) {
    return Status(StatusCode::unavailable, path + " cannot be written: " + std::strerror(errno));
  }
  std::string header(kIdentity);
  header += {1, 0, 1, 0};  // version 1.0.1
  put(header, std::uint32_t{0});
  put(header, std::numeric_limits<std::uint64_t>::max());
  put(header, static_cast<std::uint32_t>(streams.size()));
  writer.append(header);
  // Players take all streams whose NODE_ADDED comes before the first STATE_READY.
  for (const OniStreamFormat& format : streams) {
    writer.streams_.push_back({format, writer.position_, {}});
    const std::size_t index = writer.streams_.size() - 1;
    writer.append(writer.node_added(index, 0));
    writer.write_properties(index, registered);
  }
  std::string begin;
  put(begin, std::numeric_limits<std::uint32_t>::max());
  put(begin, std::numeric_limits<std::uint64_t>::max());
  for (std::size_t i = 0; i < streams.size(); ++i) {
    writer.append(record(RecordType::state_ready, i));
  }
  for (std::size_t i = 0; i < streams.size(); ++i) {
    writer.append(record(RecordType::data_begin, i, begin));
  }
  if (Status status = writer.state(); !status.ok()) return status;
  return writer;
}

std::string OniWriter::node_added(std::size_t index, std::uint64_t table_position) const {
  const Stream& stream = streams_[index];
  const bool depth = stream.format.kind == OniStreamInfo::Kind::depth;
  std::string fields;
  put_text(fields, depth ? "Depth" : "Image");
  put(fields, static_cast<std::uint32_t>(stream.format.kind));
  put(fields, kUncompressed);
  // Not known before the end, when the table is written.
  put(fields, table_position > 0 ? static_cast<std::uint32_t>(stream.frames.size())
                                 : std::numeric_limits<std::uint32_t>::max());
  put(fields, std::uint64_t{0});
  put(fields, stream.frames.empty() ? std::uint64_t{0} : stream.frames.back().stamp_us);
  put(fields, table_position);
  return record(RecordType::node_added, index, fields);
}

void OniWriter::write_properties(std::size_t index, bool registered) {
  const OniStreamFormat& format = streams_[index].format;
  append(number_property(index, "oniRequiredFrameSize", format.frame_bytes));
  append(number_property(index, "xnIsGenerating", 1));
  if (format.max_depth > 0) append(number_property(index, "xnDeviceMaxDepth", format.max_depth));
  append(number_property(index, "xnSupportedMapOutputModesCount", 1));
  std::string mode;
  put(mode, format.width);
  put(mode, format.height);
  put(mode, format.fps);
  append(property(RecordType::general_property, index, "xnSupportedMapOutputModes", mode));
  append(property(RecordType::general_property, index, kModeProperty, mode));
  append(number_property(index, "xnPixelFormat", old_pixel_format(format)));
  append(number_property(index, "oniPixelFormat", format.pixel_format));
  std::string fov;
  put(fov, format.horizontal_fov);
  put(fov, format.vertical_fov);
  append(property(RecordType::general_property, index, "xnFOV", fov));
  append(property(RecordType::general_property, index, "xnCropping", std::string(12, '\0')));
  append(number_property(index, "xnMirror", format.mirrored ? 1 : 0));
  if (format.baseline_cm > 0) append(real_property(index, "DCRCDIS", format.baseline_cm));
  if (format.kind == OniStreamInfo::Kind::depth) {
    append(number_property(index, kRegisteredProperty, registered ? 1 : 0));
  }
}

Status OniWriter::add(std::size_t index, std::int64_t stamp_us, const void* data,
                      std::size_t size) {
  Stream& stream = streams_[index];
  if (size != stream.format.frame_bytes) {
    return invalid_argument("a frame to record has " + std::to_string(size) +
                            " bytes; it must have " + std::to_string(stream.format.frame_bytes));
  }
  if (first_us_ < 0) first_us_ = stamp_us;
  const auto stamp = static_cast<std::uint64_t>(std::max<std::int64_t>(0, stamp_us - first_us_));
  std::string fields;
  put(fields, stamp);
  put(fields, static_cast<std::uint32_t>(stream.frames.size() + 1));
  const std::uint64_t previous = stream.frames.empty() ? 0 : stream.frames.back().position;
  stream.frames.push_back({stamp, position_});
  append(record(RecordType::new_data, index, fields, previous, size));
  file_.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  position_ += size;
  return state();
}

Status OniWriter::finish() {
  std::vector<std::uint64_t> tables;
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    append(record(RecordType::node_removed, i, "", streams_[i].added_position));
    tables.push_back(position_);
    std::string table;
    const auto entry = [&table](std::uint64_t stamp, std::uint64_t position) {
      put(table, stamp);
      put(table, std::uint32_t{0});  // the streams' settings never change
      put(table, position);
    };
    entry(0, 0);  // frames count from 1
    for (const FrameEntry& frame : streams_[i].frames) entry(frame.stamp_us, frame.position);
    append(record(RecordType::seek_table, i, "", 0, table.size()));
    append(table);
  }
  RecordHeader end;
  end.type = static_cast<std::uint32_t>(RecordType::end);
  end.field_bytes = kRecordHeaderBytes;
  std::string bytes;
  put_header(bytes, end);
  append(bytes);
  // Again, now with the number of frames.
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    file_.seekp(static_cast<std::streamoff>(streams_[i].added_position));
    const std::string added = node_added(i, tables[i]);
    file_.write(added.data(), static_cast<std::streamsize>(added.size()));
  }
  file_.close();
  return state();
}

std::uint32_t OniWriter::frames(std::size_t index) const {
  return index < streams_.size() ? static_cast<std::uint32_t>(streams_[index].frames.size()) : 0;
}

void OniWriter::append(const std::string& bytes) {
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  position_ += bytes.size();
}

Status OniWriter::state() const {
  if (file_) return {};
  return Status(StatusCode::unavailable,
                path_ + " cannot be written any further: is the disk full?");
}

}  // namespace bpa::camera
