// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

// Recordings of ROS 2 as rosbag2 writes them, by the specifications of MCAP and of rosbag2's SQLite
// storage. Nothing of the readers is used.

namespace bpa::support {

struct RecordedMessage {
  std::string topic;
  std::string type;
  std::int64_t time_ns = 0;
  std::string cdr;
};

enum class McapKind { no_chunks, plain, lz4, zstd };

std::string mcap_of(const std::vector<RecordedMessage>& messages, McapKind kind,
                    const std::string& encoding = "cdr");

/// `zstd`: each message is compressed.
void write_db3(const std::string& path, const std::vector<RecordedMessage>& messages,
               bool zstd = false);

}  // namespace bpa::support
