// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/io/new_file.hpp"
#include "idl/wire/field.hpp"
#include "idl/wire/qos.hpp"

namespace bpa::ros {

/// Writes a recording of ROS 2 as one MCAP file, as rosbag2 does: chunks of zstd, an index of their
/// messages, definitions of the types. The file has its name from the start. What a crash cuts
/// short can be read up to its last chunk.
///
/// Functions fail with unavailable, which names the path and the system's reason; after that all
/// do.
class McapWriter {
 public:
  /// Fails where the path does not end with .mcap, or is there already.
  static Result<McapWriter> create(const std::string& path);

  /// A topic of the recording; returns its number. `qos`: what its publishers offer.
  std::uint16_t add_topic(const std::string& name, const wire::MessageDefinition& type,
                          const wire::Qos& qos);
  /// A message of a topic. Times are UTC: when it was received, and when it was sent. `cdr` has its
  /// header.
  Status add(std::uint16_t topic, std::int64_t received_ns, std::int64_t sent_ns,
             std::string_view cdr);
  /// Writes what was added so far, as a chunk; add() does so for each MiB.
  Status end_chunk();
  /// Completes the file. The last call.
  Status finish();

  std::uint64_t message_count() const { return message_count_; }
  std::uint64_t bytes() const { return file_.size(); }

 private:
  explicit McapWriter(io::NewFile file) : file_(std::move(file)) {}

  /// When the first and the last of some messages were received.
  struct Span {
    std::int64_t begin_ns = 0, end_ns = 0;
  };

  io::NewFile file_;
  std::string chunk_;  ///< Its records.
  Span chunk_span_, span_;
  /// Times of the chunk's messages and where they are in it, by topic.
  std::map<std::uint16_t, std::vector<std::pair<std::int64_t, std::uint64_t>>> index_;
  std::string schemas_, topics_, chunk_indexes_;  ///< Records of the summary.
  std::uint32_t chunk_count_ = 0;
  std::map<std::string, std::uint16_t> schema_numbers_;
  std::map<std::uint16_t, std::uint64_t> counts_;  ///< Messages by topic.
  std::uint64_t message_count_ = 0;
};

}  // namespace bpa::ros
