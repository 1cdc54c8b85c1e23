// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/status.hpp"

// ROS names and what they are called in DDS.

namespace bpa::wire {

/// "/camera/image" -> "rt/camera/image".
std::string dds_topic_name(std::string_view full_name);
/// "/bpa/detect" -> "rq/bpa/detectRequest".
std::string dds_request_topic_name(std::string_view full_name);
/// "/bpa/detect" -> "rr/bpa/detectReply".
std::string dds_reply_topic_name(std::string_view full_name);
/// "sensor_msgs/msg/Image" -> "sensor_msgs::msg::dds_::Image_".
std::string dds_type_name(std::string_view type);

/// Whether a full name, such as "/bpa/detect", keeps ROS's rules; the message says which it breaks.
Status validate_full_name(std::string_view name);

/// "from:=to" on a ROS command line; both as a user writes them, relative names allowed.
struct Remap {
  std::string from;
  std::string to;
};

/// Reads "from:=to".
Result<Remap> parse_remap(std::string_view text);

/// Whose names are looked up.
struct NodeName {
  std::string node_namespace = "/";  ///< "/" or "/a/b".
  std::string name = "bpa";

  /// "/bpa" or "/a/b/bpa".
  std::string full() const;
};

/// The fully qualified name of `name` as the node sees it: "x" is below its namespace, "~/x" below
/// its own name, "/x" stays; then the first remap whose `from` is the same name applies.
Result<std::string> resolve_name(std::string_view name, const NodeName& node,
                                 const std::vector<Remap>& remaps = {});

}  // namespace bpa::wire
