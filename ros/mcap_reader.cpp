// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <fstream>
#include <map>
#include <utility>

#include <lz4frame.h>

#include "core/base/concat.hpp"
#include "core/io/file_bytes.hpp"
#include "ros/private/bag_files.hpp"
#include "ros/private/mcap.hpp"

// Schemas and channels come before the messages that use them, so the file
// is read in its order, without its index: a recording that was cut short is read as far as it
// goes.

namespace bpa::ros {
namespace {

/// Reads the fields of a record; after a failure, all are 0 or empty.
class Fields {
 public:
  explicit Fields(std::string_view bytes) : left_(bytes) {}

  template <class T>
  T number() {
    T value{};
    const std::string_view bytes = take(sizeof value);
    if (ok_) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  template <class Length = std::uint32_t>
  std::string_view block() {
    return take(number<Length>());
  }
  std::string_view rest() { return take(left_.size()); }
  bool empty() const { return left_.empty(); }
  bool ok() const { return ok_; }

 private:
  std::string_view take(std::uint64_t size) {
    ok_ = ok_ && size <= left_.size();
    if (!ok_) return {};
    const std::string_view taken = left_.substr(0, size);
    left_.remove_prefix(size);
    return taken;
  }

  std::string_view left_;
  bool ok_ = true;
};

std::optional<std::string> unlz4(std::string_view bytes, std::uint64_t size) {
  if (size / 255 > bytes.size()) return {};  // lz4 cannot pack it so tightly
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0U) return {};
  std::string out(size, '\0');
  std::size_t written = 0, hint = 1;
  while (hint != 0 && LZ4F_isError(hint) == 0U && !(bytes.empty() && written == size)) {
    std::size_t to = size - written, from = bytes.size();
    hint = LZ4F_decompress(context, out.data() + written, &to, bytes.data(), &from, nullptr);
    if (to == 0 && from == 0) break;
    written += to;
    bytes.remove_prefix(from);
  }
  LZ4F_freeDecompressionContext(context);
  if (hint != 0 || written != size) return {};
  return out;
}

class McapReader : public BagReader {
 public:
  McapReader(std::string path, std::ifstream file, std::uint64_t size)
      : path_(std::move(path)), file_(std::move(file)), left_(size - kMagic.size()) {}

  Result<std::optional<BagMessage>> next() override {
    while (true) {
      if (chunk_.empty()) {
        Result<bool> more = read_record();
        if (!more.ok()) return more.status();
        if (!*more) return std::optional<BagMessage>();
      }
      while (!chunk_.empty()) {
        const auto opcode = chunk_.number<std::uint8_t>();
        const std::string_view content = chunk_.block<std::uint64_t>();
        if (!chunk_.ok()) return damaged("a chunk");
        Result<std::optional<BagMessage>> message = read(opcode, content);
        if (!message.ok() || *message) return message;
      }
    }
  }

 private:
  Status damaged(const char* what) const {
    return corrupt(path_, ": ", what, " is damaged, after ", count_, " messages");
  }

  Status cut_short() const {
    return corrupt(path_, " is cut short, after ", count_, " messages; `mcap recover` mends it");
  }

  /// Makes the records of the next chunk, or the next record outside of chunks, those to read.
  Result<bool> read_record() {
    char head[9];
    if (left_ < sizeof head || !file_.read(head, sizeof head)) {
      return cut_short();
    }
    std::uint64_t length = 0;
    std::memcpy(&length, head + 1, sizeof length);
    left_ -= sizeof head;
    const auto opcode = static_cast<std::uint8_t>(head[0]);
    if (opcode == kDataEnd || opcode == kFooter) return false;
    if (length > left_) {
      return cut_short();
    }
    left_ -= length;
    if (opcode != kChunk && opcode != kSchema && opcode != kChannel && opcode != kMessage) {
      file_.seekg(static_cast<std::streamoff>(length), std::ios::cur);
      return true;  // an index, an attachment, or what a later version adds
    }
    record_.assign(head, sizeof head);
    record_.resize(sizeof head + length);
    if (!file_.read(record_.data() + sizeof head, static_cast<std::streamsize>(length))) {
      return unavailable(path_, " cannot be read");
    }
    if (opcode == kChunk) return read_chunk();
    chunk_ = Fields(record_);
    return true;
  }

  Result<bool> read_chunk() {
    Fields fields(std::string_view(record_).substr(9));
    (void)fields.number<std::uint64_t>();  // the first and the last time
    (void)fields.number<std::uint64_t>();
    const auto size = fields.number<std::uint64_t>();
    const auto crc = fields.number<std::uint32_t>();
    const std::string_view compression = fields.block();
    const std::string_view records = fields.block<std::uint64_t>();
    if (!fields.ok()) return damaged("a chunk");
    if (size > kMostDecompressed) {
      return corrupt(path_, ": a chunk has ", size, " bytes; at most ", kMostDecompressed,
                     " are read");
    }
    if (compression == "lz4") {
      auto plain = unlz4(records, size);
      if (!plain) return damaged("a chunk");
      plain_ = *std::move(plain);
    } else if (compression == "zstd") {
      auto plain = unzstd(records, size);
      if (!plain.ok()) return damaged("a chunk");
      plain_ = std::move(plain).value();
    } else if (compression.empty()) {
      plain_ = records;
    } else {
      return Status(StatusCode::unsupported, concat(path_, ": its chunks are compressed with ",
                                                    compression, "; lz4 and zstd are read"));
    }
    if (crc != 0 && crc != io::crc32(plain_)) return damaged("a chunk");
    chunk_ = Fields(plain_);
    return true;
  }

  /// Takes up a schema or a channel; gives a message.
  Result<std::optional<BagMessage>> read(std::uint8_t opcode, std::string_view content) {
    Fields fields(content);
    const auto id = fields.number<std::uint16_t>();
    if (opcode == kSchema) {
      schemas_[id] = fields.block();
      if (!fields.ok()) return damaged("a schema");
    } else if (opcode == kChannel) {
      const auto schema = fields.number<std::uint16_t>();
      Channel channel{{std::string(fields.block()), schemas_[schema]}, std::string(fields.block())};
      if (!fields.ok()) return damaged("a channel");
      channels_.try_emplace(id, std::move(channel));
    } else if (opcode == kMessage) {
      (void)fields.number<std::uint32_t>();  // its sequence
      const auto time = fields.number<std::uint64_t>();
      (void)fields.number<std::uint64_t>();  // when it was published
      const auto channel = channels_.find(id);
      if (!fields.ok() || channel == channels_.end()) return damaged("a message");
      ++count_;
      if (channel->second.encoding == "cdr") {
        return std::optional(
            BagMessage{&channel->second.topic, static_cast<std::int64_t>(time), fields.rest()});
      }
      if (channel->second.encoding == "ros1") {
        return Status(StatusCode::unsupported,
                      path_ +
                          " has messages of ROS 1; rosbags-convert of the Python package rosbags "
                          "makes a recording of ROS 2");
      }
    }
    return std::optional<BagMessage>();
  }

  struct Channel {
    BagTopic topic;
    std::string encoding;
  };

  const std::string path_;
  std::ifstream file_;
  std::uint64_t left_;          ///< Bytes of the file that were not read yet.
  std::uint64_t count_ = 0;     ///< Messages so far.
  std::string record_, plain_;  ///< The last record; the records of the last chunk.
  Fields chunk_{{}};            ///< What is left of them.
  std::map<std::uint16_t, std::string> schemas_;  ///< Names of types.
  std::map<std::uint16_t, Channel> channels_;
};

}  // namespace

Result<std::unique_ptr<BagReader>> open_mcap(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return not_found(path, " cannot be opened");
  const auto size = static_cast<std::uint64_t>(file.tellg());
  file.seekg(0);
  std::string magic(kMagic.size(), '\0');
  if (!file.read(magic.data(), static_cast<std::streamsize>(magic.size())) || magic != kMagic) {
    return corrupt(path, " is no MCAP file");
  }
  return std::unique_ptr<BagReader>(std::make_unique<McapReader>(path, std::move(file), size));
}

}  // namespace bpa::ros
