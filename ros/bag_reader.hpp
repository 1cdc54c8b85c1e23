// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/status.hpp"

// Recordings of ROS 2 (rosbag2), without ROS: MCAP files (chunks plain, lz4 or zstd) and SQLite
// files, alone or as metadata.yaml lists them; messages compressed one by one, too.

namespace bpa::ros {

struct BagTopic {
  std::string name;  ///< "/camera/depth/image_raw".
  std::string type;  ///< "sensor_msgs/msg/Image".
};

/// A message of a recording. Valid until the reader is asked for the next one.
struct BagMessage {
  const BagTopic* topic = nullptr;
  std::int64_t time_ns = 0;  ///< When it was recorded, UTC.
  std::string_view bytes;    ///< CDR, with its header.
};

/// Reads a recording from its beginning, message by message, as they were recorded.
class BagReader {
 public:
  virtual ~BagReader() = default;
  /// Nothing at the end. Fails with corrupt, naming the file, where it is damaged or cut short.
  virtual Result<std::optional<BagMessage>> next() = 0;
};

/// `path`: a .mcap or .db3 file, or the folder of a recording. Fails with not_found, corrupt, or
/// unsupported for ROS 1 and files that are compressed as a whole; the message says what to do.
Result<std::unique_ptr<BagReader>> open_bag(const std::string& path);

}  // namespace bpa::ros
