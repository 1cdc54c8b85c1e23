// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/oni_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include "core/base/concat.hpp"

namespace bpa::camera {
namespace {

using namespace oni;

/// Walks over the records of one file.
class Inspector {
 public:
  Inspector(const std::string& path, std::uint64_t size)
      : path_(path), size_(size), file_(path, std::ios::binary) {}

  Result<OniFileInfo> inspect() {
    if (Status status = check_header(); !status.ok()) return status;
    while (!ended_) {
      if (Status status = next_record(); !status.ok()) return status;
    }
    for (const Node& node : nodes_) {
      if (node.seen != node.stream.frames) {
        return damaged("its ", node.stream.frames, " frames of stream ", node.stream.node, " are ",
                       node.seen);
      }
      info_.streams.push_back(node.stream);
    }
    if (info_.find(OniStreamInfo::Kind::depth) == nullptr) {
      return damaged("it holds no depth stream");
    }
    return info_;
  }

 private:
  struct Node {
    OniStreamInfo stream;
    std::uint32_t codec = 0;
    std::uint32_t seen = 0;  ///< Frame records so far.
  };

  Status damaged(const auto&... why) const { return corrupt(path_, " is damaged: ", why...); }
  Status truncated() const {
    std::uint32_t frames = 0;
    for (const Node& node : nodes_) frames = std::max(frames, node.seen);
    return corrupt(path_, " is truncated: it ends at byte ", size_, ", after ", frames,
                   " frames, without the records that end a recording");
  }

  /// The next bytes of the file; false past its end.
  bool read(std::string& bytes, std::size_t count) {
    if (size_ - position_ < count) return false;
    bytes.resize(count);
    file_.seekg(static_cast<std::streamoff>(position_));
    file_.read(bytes.data(), static_cast<std::streamsize>(count));
    return static_cast<bool>(file_);
  }

  Status check_header() {
    std::string bytes;
    if (!read(bytes, kFileHeaderBytes) || !bytes.starts_with(kIdentity)) {
      return corrupt(path_, " is no OpenNI recording: it does not begin with NI10");
    }
    const auto part = [&](std::size_t i) { return int{static_cast<unsigned char>(bytes[i])}; };
    const std::string version = concat(part(4), ".", part(5), ".", part(6));
    if (version != "1.0.1") {
      return Status(StatusCode::unsupported,
                    path_ + " has the format " + version +
                        "; only 1.0.1 can be checked, so record it again with OpenNI2");
    }
    position_ = kFileHeaderBytes;
    return {};
  }

  Status next_record() {
    std::string bytes;
    RecordHeader header;
    std::size_t offset = 0;
    if (!read(bytes, sizeof header) || !get(bytes, offset, header)) return truncated();
    const std::string place = concat("the record at byte ", position_);
    if (header.magic != RecordHeader::kMagic || header.type < kFirstType ||
        header.type > kLastType || header.field_bytes < sizeof header ||
        header.field_bytes > kMaxFieldBytes ||
        (header.type == RecordType::new_data && header.payload_bytes > kMaxFrameBytes)) {
      return damaged(place, " is none");
    }
    const std::uint64_t record_bytes = std::uint64_t{header.field_bytes} + header.payload_bytes;
    if (size_ - position_ < record_bytes || !read(bytes, header.field_bytes)) return truncated();
    if (!take(header, bytes, offset)) return damaged(place, " has wrong fields");
    position_ += record_bytes;
    return {};
  }

  bool take(const RecordHeader& header, const std::string& bytes, std::size_t offset) {
    switch (header.type) {
      case RecordType::node_added:
        return take_node(header, bytes, offset);
      case RecordType::int_property:
      case RecordType::general_property:
        return take_property(header, bytes, offset);
      case RecordType::new_data:
        return take_frame(header, bytes, offset);
      default:
        ended_ = header.type == RecordType::end;
        return true;
    }
  }

  bool take_node(const RecordHeader& header, const std::string& bytes, std::size_t offset) {
    std::string name;
    NodeFields fields;
    if (!get_text(bytes, offset, name) || !get(bytes, offset, fields)) return false;
    if (fields.kind != 2 && fields.kind != 3 && fields.kind != 5) return true;  // the device itself
    const auto kind = static_cast<OniStreamInfo::Kind>(fields.kind);
    nodes_.push_back({{header.node, kind, fields.frames, 0, 0, 0}, fields.codec});
    return true;
  }

  bool take_property(const RecordHeader& header, const std::string& bytes, std::size_t offset) {
    std::string name;
    std::uint32_t size = 0;
    if (!get_text(bytes, offset, name) || !get(bytes, offset, size)) return false;
    if (bytes.size() - offset < size) return false;
    Node* node = find(header.node);
    if (name == kModeProperty && node != nullptr) {
      ModeValue mode;
      if (!get(bytes, offset, mode)) return false;
      node->stream.width = mode.width;
      node->stream.height = mode.height;
      node->stream.fps = mode.fps;
    } else if (name == kRegisteredProperty) {
      std::uint64_t value = 0;
      if (!get(bytes, offset, value)) return false;
      info_.registered = value != 0 ? OniFileInfo::Registered::yes : OniFileInfo::Registered::no;
    }
    return true;
  }

  bool take_frame(const RecordHeader& header, const std::string& bytes, std::size_t offset) {
    FrameFields fields;
    Node* node = find(header.node);
    if (node == nullptr || !get(bytes, offset, fields)) return false;
    if (fields.number > node->stream.frames) return false;
    // A raw frame has at least a byte for each pixel; the player copies what the mode says.
    const std::uint64_t pixels = std::uint64_t{node->stream.width} * node->stream.height;
    if (node->codec == kUncompressed && header.payload_bytes < pixels) return false;
    ++node->seen;
    return true;
  }

  Node* find(std::uint32_t id) {
    const auto node = std::ranges::find(nodes_, id, [](const Node& n) { return n.stream.node; });
    return node != nodes_.end() ? &*node : nullptr;
  }

  const std::string path_;
  const std::uint64_t size_;
  std::ifstream file_;
  std::uint64_t position_ = 0;
  bool ended_ = false;
  OniFileInfo info_;
  std::vector<Node> nodes_;
};

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

const OniStreamInfo* OniFileInfo::find(OniStreamInfo::Kind kind) const {
  const auto stream = std::ranges::find(streams, kind, &OniStreamInfo::kind);
  return stream != streams.end() ? &*stream : nullptr;
}

Result<OniFileInfo> inspect_oni_file(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return not_found(path, ": there is no such file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return unavailable(path, ": ", error.message());
  return Inspector(path, size).inspect();
}

Result<OniWriter> OniWriter::create(const std::string& path,
                                    const std::vector<OniStreamFormat>& streams, bool registered) {
  for (const OniStreamFormat& format : streams) {
    if (format.frame_bytes <= kMaxFrameBytes) continue;
    return Status(
        StatusCode::unsupported,
        concat("frames of ", format.frame_bytes,
               " bytes cannot be recorded; players of .oni files have room for ", kMaxFrameBytes));
  }
  auto file = io::NewFile::create(path, path + ".part");
  if (!file.ok()) return file.status();
  OniWriter writer(path, std::move(file).value());
  std::string header(kIdentity);
  header += {1, 0, 1, 0};  // version 1.0.1
  put(header, std::uint32_t{0});
  put(header, std::numeric_limits<std::uint64_t>::max());
  put(header, static_cast<std::uint32_t>(streams.size()));
  writer.append(header);
  // Players take all streams whose NODE_ADDED comes before the first STATE_READY.
  for (const OniStreamFormat& format : streams) {
    const auto node = static_cast<std::uint32_t>(writer.streams_.size() + 1);
    const Stream& stream = writer.streams_.emplace_back(Stream{format, node, writer.bytes()});
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
  stream.frames.push_back({stamp, 0, bytes()});
  append(record(RecordType::new_data, stream.node, fields, previous, size));
  append({static_cast<const char*>(data), size});
  return state();
}

Status OniWriter::finish() {
  for (Stream& stream : streams_) {
    append(record(RecordType::node_removed, stream.node, "", stream.added_position));
    stream.table_position = bytes();
    std::string table;
    for (const SeekEntry& frame : stream.frames) put(table, frame);
    append(record(RecordType::seek_table, stream.node, "", 0, table.size()) + table);
  }
  append(record(RecordType::end, 0));
  // Again, now with the number of frames.
  for (const Stream& stream : streams_) {
    if (state_.ok()) state_ = file_.overwrite(stream.added_position, node_added(stream));
  }
  if (state_.ok()) state_ = file_.commit();
  return state();
}

std::uint32_t OniWriter::frames(std::size_t index) const {
  return index < streams_.size() ? static_cast<std::uint32_t>(streams_[index].frames.size() - 1)
                                 : 0;
}

void OniWriter::append(std::string_view bytes) {
  if (state_.ok()) state_ = file_.append(bytes);
}

Status OniWriter::state() const {
  if (state_.ok()) return {};
  return unavailable(state_.message, "; what was recorded before is in ", path_, ".part");
}

}  // namespace bpa::camera
