// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/oni_file.hpp"

#include <algorithm>
#include <filesystem>
#include <map>

#include "camera/oni_records.hpp"

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
    for (const auto& [node, frames] : frames_) {
      const OniStreamInfo* stream = find(node);
      if (stream != nullptr && stream->frames != frames) {
        return corrupt("its " + std::to_string(stream->frames) + " frames of stream " +
                       std::to_string(node) + " are " + std::to_string(frames));
      }
    }
    if (info_.find(OniStreamInfo::Kind::depth) == nullptr) {
      return corrupt("it holds no depth stream");
    }
    return info_;
  }

 private:
  Status corrupt(const std::string& why) const {
    return Status(StatusCode::corrupt, path_ + " is damaged: " + why);
  }
  Status truncated() const {
    std::uint32_t frames = 0;
    for (const auto& [node, count] : frames_) frames = std::max(frames, count);
    return Status(StatusCode::corrupt,
                  path_ + " is truncated: it ends at byte " + std::to_string(size_) + ", after " +
                      std::to_string(frames) + " frames, without the records that end a recording");
  }

  bool read(std::string& bytes, std::size_t count) {
    bytes.resize(count);
    file_.seekg(static_cast<std::streamoff>(position_));
    file_.read(bytes.data(), static_cast<std::streamsize>(count));
    return static_cast<bool>(file_);
  }

  Status check_header() {
    std::string bytes;
    if (size_ < kFileHeaderBytes || !read(bytes, kFileHeaderBytes) ||
        bytes.compare(0, 4, kIdentity) != 0) {
      return Status(StatusCode::corrupt,
                    path_ + " is no OpenNI recording: it does not begin with NI10");
    }
    const auto major = static_cast<unsigned char>(bytes[4]);
    const auto minor = static_cast<unsigned char>(bytes[5]);
    const auto maintenance = static_cast<unsigned char>(bytes[6]);
    if (major != 1 || minor != 0 || maintenance != 1) {
      return Status(StatusCode::unsupported,
                    path_ + " has the format " + std::to_string(major) + "." +
                        std::to_string(minor) + "." + std::to_string(maintenance) +
                        "; only 1.0.1 can be checked, so record it again with OpenNI2");
    }
    position_ = kFileHeaderBytes;
    return {};
  }

  Status next_record() {
    std::string bytes;
    if (size_ - position_ < kRecordHeaderBytes || !read(bytes, kRecordHeaderBytes)) {
      return truncated();
    }
    const RecordHeader header = get_header(bytes);
    const bool data = header.type == static_cast<std::uint32_t>(RecordType::new_data);
    const std::string place = "the record at byte " + std::to_string(position_);
    if (header.magic != kMagic || header.type < kFirstType || header.type > kLastType ||
        header.field_bytes < kRecordHeaderBytes || header.field_bytes > kMaxFieldBytes ||
        (data && header.payload_bytes > kMaxFrameBytes)) {
      return corrupt(place + " is none");
    }
    const std::uint64_t record_bytes =
        std::uint64_t{header.field_bytes} + std::uint64_t{header.payload_bytes};
    if (size_ - position_ < record_bytes) return truncated();
    if (!read(bytes, header.field_bytes)) return truncated();
    if (!take(header, bytes)) return corrupt(place + " has wrong fields");
    position_ += record_bytes;
    return {};
  }

  bool take(const RecordHeader& header, const std::string& bytes) {
    std::size_t offset = kRecordHeaderBytes;
    switch (static_cast<RecordType>(header.type)) {
      case RecordType::node_added:
        return take_node(header, bytes, offset);
      case RecordType::int_property:
      case RecordType::general_property:
        return take_property(header, bytes, offset);
      case RecordType::new_data:
        return take_frame(header, bytes, offset);
      case RecordType::end:
        ended_ = true;
        return true;
      default:
        return true;
    }
  }

  bool take_node(const RecordHeader& header, const std::string& bytes, std::size_t offset) {
    std::string name;
    std::uint32_t kind = 0, codec = 0, frames = 0;
    if (!get_text(bytes, offset, name) || !get(bytes, offset, kind) || !get(bytes, offset, codec) ||
        !get(bytes, offset, frames)) {
      return false;
    }
    if (kind != 2 && kind != 3 && kind != 5) return true;  // the device itself
    codecs_[header.node] = codec;
    info_.streams.push_back({header.node, static_cast<OniStreamInfo::Kind>(kind), frames, 0, 0, 0});
    frames_[header.node] = 0;
    return true;
  }

  bool take_property(const RecordHeader& header, const std::string& bytes, std::size_t offset) {
    std::string name;
    std::uint32_t size = 0;
    if (!get_text(bytes, offset, name) || !get(bytes, offset, size)) return false;
    if (bytes.size() - offset < size) return false;
    OniStreamInfo* stream = find(header.node);
    if (name == kModeProperty && stream != nullptr) {
      return get(bytes, offset, stream->width) && get(bytes, offset, stream->height) &&
             get(bytes, offset, stream->fps);
    }
    if (name == kRegisteredProperty) {
      std::uint64_t value = 0;
      if (!get(bytes, offset, value)) return false;
      info_.registered = value != 0 ? OniFileInfo::Registered::yes : OniFileInfo::Registered::no;
    }
    return true;
  }

  bool take_frame(const RecordHeader& header, const std::string& bytes, std::size_t offset) {
    std::uint64_t stamp = 0;
    std::uint32_t number = 0;
    const OniStreamInfo* stream = find(header.node);
    if (stream == nullptr || !get(bytes, offset, stamp) || !get(bytes, offset, number))
      return false;
    if (number > stream->frames) return false;
    // A raw frame has at least a byte for each pixel; the player copies what the mode says.
    const std::uint64_t pixels = std::uint64_t{stream->width} * stream->height;
    if (codecs_[header.node] == kUncompressed && header.payload_bytes < pixels) return false;
    ++frames_[header.node];
    return true;
  }

  OniStreamInfo* find(std::uint32_t node) {
    for (OniStreamInfo& stream : info_.streams) {
      if (stream.node == node) return &stream;
    }
    return nullptr;
  }

  const std::string path_;
  const std::uint64_t size_;
  std::ifstream file_;
  std::uint64_t position_ = 0;
  bool ended_ = false;
  OniFileInfo info_;
  std::map<std::uint32_t, std::uint32_t> codecs_;
  std::map<std::uint32_t, std::uint32_t> frames_;  ///< Frame records seen, by node.
};

}  // namespace

const OniStreamInfo* OniFileInfo::find(OniStreamInfo::Kind kind) const {
  for (const OniStreamInfo& stream : streams) {
    if (stream.kind == kind) return &stream;
  }
  return nullptr;
}

Result<OniFileInfo> inspect_oni_file(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return Status(StatusCode::not_found, path + ": there is no such file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return Status(StatusCode::unavailable, path + ": " + error.message());
  return Inspector(path, size).inspect();
}

}  // namespace bpa::camera
