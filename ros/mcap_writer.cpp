// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "ros/mcap_writer.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <type_traits>

#include <zstd.h>

#include "core/base/concat.hpp"
#include "core/io/file_bytes.hpp"
#include "ros/private/mcap.hpp"

namespace bpa::ros {
namespace {

constexpr std::size_t kChunkBytes = 1'048'576;
constexpr int kZstdLevel = 1;  // the fastest: cameras do not wait
constexpr std::size_t kRecordHead = 9;

template <class T>
void put(std::string& bytes, const T& value) {
  if constexpr (std::is_arithmetic_v<T>) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  } else {
    const std::string_view text = value;
    put(bytes, static_cast<std::uint32_t>(text.size()));
    bytes += text;
  }
}

/// A record of these fields; `tail` follows as it is.
template <class... Fields>
void put_record(std::string& bytes, Opcode opcode, std::string_view tail, const Fields&... fields) {
  const std::size_t begin = bytes.size();
  bytes += static_cast<char>(opcode);
  put(bytes, std::uint64_t{0});
  (put(bytes, fields), ...);
  bytes += tail;
  const std::uint64_t length = bytes.size() - begin - kRecordHead;
  std::memcpy(bytes.data() + begin + 1, &length, sizeof length);
}

/// An array or map of numbers.
template <class Pairs>
std::string pairs_text(const Pairs& pairs) {
  std::string bytes;
  for (const auto& [first, second] : pairs) {
    put(bytes, first);
    put(bytes, second);
  }
  return bytes;
}

/// As rosbag2 of Humble writes it, by the numbers of rmw; later ones read it, too. DDS does not
/// tell of the history.
std::string qos_text(const wire::Qos& qos) {
  const char* forever = "{sec: 9223372036, nsec: 854775807}";
  return concat("- {history: 3, depth: 0, reliability: ",
                qos.reliability == wire::Reliability::reliable ? 1 : 2,
                ", durability: ", qos.durability == wire::Durability::transient_local ? 1 : 2,
                ", deadline: ", forever, ", lifespan: ", forever,
                ", liveliness: 1, liveliness_lease_duration: ", forever,
                ", avoid_ros_namespace_conventions: false}\n");
}

}  // namespace

Result<McapWriter> McapWriter::create(const std::string& path) {
  if (io::lower_extension(path) != "mcap") return invalid_argument(path, " must end with .mcap");
  std::error_code error;
  if (std::filesystem::exists(path, error)) return invalid_argument(path, ": is there already");
  Result<io::NewFile> file = io::NewFile::create(path, path);
  if (!file.ok()) return file.status();
  McapWriter writer(std::move(file).value());
  std::string head(kMagic);
  put_record(head, kHeader, "", "ros2", "bpa");
  if (Status status = writer.file_.append(head); !status.ok()) return status;
  return writer;
}

std::uint16_t McapWriter::add_topic(const std::string& name, const wire::MessageDefinition& type,
                                    const wire::Qos& qos) {
  std::string records;
  const auto [schema, is_new] = schema_numbers_.try_emplace(
      type.name, static_cast<std::uint16_t>(schema_numbers_.size() + 1));
  if (is_new) put_record(records, kSchema, "", schema->second, type.name, "ros2msg", type.text);
  schemas_ += records;
  chunk_ += records;
  records.clear();
  const auto number = static_cast<std::uint16_t>(counts_.size() + 1);
  std::string metadata;
  for (const std::string& text : {std::string("offered_qos_profiles"), qos_text(qos),
                                  std::string("topic_type_hash"), std::string(type.hash)}) {
    put(metadata, text);
  }
  put_record(records, kChannel, "", number, schema->second, name, "cdr", metadata);
  topics_ += records;
  chunk_ += records;
  counts_[number] = 0;
  return number;
}

Status McapWriter::add(std::uint16_t topic, std::int64_t received_ns, std::int64_t sent_ns,
                       std::string_view cdr) {
  if (index_.empty()) chunk_span_ = {received_ns, received_ns};
  if (message_count_ == 0) span_ = chunk_span_;
  for (Span* span : {&span_, &chunk_span_}) {
    span->begin_ns = std::min(span->begin_ns, received_ns);
    span->end_ns = std::max(span->end_ns, received_ns);
  }
  index_[topic].emplace_back(received_ns, chunk_.size());
  ++counts_[topic];
  ++message_count_;
  put_record(chunk_, kMessage, cdr, topic, std::uint32_t{0}, received_ns, sent_ns);
  return chunk_.size() < kChunkBytes ? Status() : end_chunk();
}

Status McapWriter::end_chunk() {
  if (index_.empty()) return {};
  std::string packed(ZSTD_compressBound(chunk_.size()), '\0');
  packed.resize(
      ZSTD_compress(packed.data(), packed.size(), chunk_.data(), chunk_.size(), kZstdLevel));
  const std::uint64_t begin = file_.size(), plain_size = chunk_.size(), packed_size = packed.size();
  std::string bytes;
  put_record(bytes, kChunk, packed, chunk_span_.begin_ns, chunk_span_.end_ns, plain_size,
             io::crc32(chunk_), "zstd", packed_size);
  const std::uint64_t chunk_length = bytes.size();
  std::map<std::uint16_t, std::uint64_t> index_offsets;
  for (const auto& [topic, messages] : index_) {
    index_offsets[topic] = begin + bytes.size();
    put_record(bytes, kMessageIndex, "", topic, pairs_text(messages));
  }
  put_record(chunk_indexes_, kChunkIndex, "", chunk_span_.begin_ns, chunk_span_.end_ns, begin,
             chunk_length, pairs_text(index_offsets), bytes.size() - chunk_length, "zstd",
             packed_size, plain_size);
  ++chunk_count_;
  chunk_.clear();
  index_.clear();
  return file_.append(bytes);
}

Status McapWriter::finish() {
  if (Status status = end_chunk(); !status.ok()) return status;
  std::string data_end;
  put_record(data_end, kDataEnd, "", std::uint32_t{0});
  if (Status status = file_.append(data_end); !status.ok()) return status;

  std::string statistics;
  put_record(statistics, kStatistics, "", message_count_,
             static_cast<std::uint16_t>(schema_numbers_.size()),
             static_cast<std::uint32_t>(counts_.size()), std::uint32_t{0}, std::uint32_t{0},
             chunk_count_, span_.begin_ns, span_.end_ns, pairs_text(counts_));
  const std::uint64_t begin = file_.size();
  std::string summary, offsets;
  for (const auto& [opcode, records] :
       {std::pair(kSchema, &schemas_), std::pair(kChannel, &topics_),
        std::pair(kStatistics, &statistics), std::pair(kChunkIndex, &chunk_indexes_)}) {
    if (records->empty()) continue;
    put_record(offsets, kSummaryOffset, "", static_cast<std::uint8_t>(opcode),
               begin + summary.size(), std::uint64_t{records->size()});
    summary += *records;
  }
  const std::uint64_t offsets_begin = begin + summary.size();
  summary += offsets;
  put_record(summary, kFooter, "", begin, offsets_begin, std::uint32_t{0});
  const std::uint32_t crc =
      io::crc32(std::string_view(summary).substr(0, summary.size() - sizeof crc));
  std::memcpy(summary.data() + summary.size() - sizeof crc, &crc, sizeof crc);
  summary += kMagic;
  if (Status status = file_.append(summary); !status.ok()) return status;
  return file_.commit();
}

}  // namespace bpa::ros
