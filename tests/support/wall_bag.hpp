// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "idl/wire/cdr.hpp"
#include "idl/wire/msg/tf2_msgs.hpp"
#include "tests/support/bag_writer.hpp"
#include "tests/support/wall_messages.hpp"

namespace bpa::support {

inline constexpr std::int64_t kSecond = 1'000'000'000;

template <class Message>
RecordedMessage recorded(const std::string& topic, std::int64_t time_ns, const Message& message) {
  const auto bytes = wire::encode(message);
  return {topic, Message::kType, time_ns, {bytes.begin(), bytes.end()}};
}

inline wire::tf2_msgs::TFMessage transform() {
  wire::tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms[0].child_frame_id = "wall_camera";
  message.transforms[0].header.frame_id = "base";
  return message;
}

/// A camera's frames, a second apart.
inline std::vector<RecordedMessage> recording(int frames = 3, const std::string& ns = "/camera") {
  std::vector<RecordedMessage> messages{recorded("/tf_static", kSecond, transform())};
  for (int i = 1; i <= frames; ++i) {
    const std::int64_t stamp = i * kSecond;
    messages.push_back(recorded(ns + "/camera_info", stamp, wall_camera_info(stamp)));
    messages.push_back(recorded(ns + "/color", stamp, wall_color_image(stamp)));
    messages.push_back(recorded(ns + "/depth", stamp + 5, wall_depth_image(stamp)));
  }
  return messages;
}

}  // namespace bpa::support
