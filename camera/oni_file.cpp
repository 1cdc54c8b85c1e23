// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/oni_file.hpp"

#include <algorithm>
#include <filesystem>

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

  template <class... Parts>
  Status damaged(const Parts&... why) const {
    return corrupt(path_, " is damaged: ", why...);
  }
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

}  // namespace bpa::camera
