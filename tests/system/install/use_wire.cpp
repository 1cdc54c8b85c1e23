// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include <bpa/wire/messages.hpp>
#include <bpa/wire/names.hpp>
#include <bpa/wire/service.hpp>

// A generated message with its hash, there and back, and its name in DDS.
int main() {
  bpa::wire::geometry_msgs::PoseStamped pose;
  pose.header.frame_id = "camera";
  const auto bytes = bpa::wire::encode(pose);
  bpa::wire::geometry_msgs::PoseStamped back;
  const bpa::Status status = bpa::wire::decode(bytes.data(), bytes.size(), back);
  const std::string name = bpa::wire::dds_type_name(pose.kType);
  std::cout << name << ' ' << pose.kTypeHash << '\n';
  return status.ok() && back.header.frame_id == "camera" && back.pose.orientation.w == 1 &&
                 name == "geometry_msgs::msg::dds_::PoseStamped_"
             ? 0
             : 1;
}
