// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/cloud/frame.hpp"
#include "idl/wire/msg/sensor_msgs.hpp"
#include "idl/wire/time.hpp"
#include "tests/support/wall_messages.hpp"

namespace bpa::test {

/// A frame as a camera's topics have it, in the frame "optical".
struct CameraMessages {
  CameraMessages(const Frame& frame, std::int64_t stamp_ns) {
    const Camera& camera = frame.camera;
    info.header = {wire::builtin_interfaces::from_ns(stamp_ns), "optical"};
    info.width = static_cast<std::uint32_t>(camera.width);
    info.height = static_cast<std::uint32_t>(camera.height);
    info.k = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
    depth.header = info.header;
    depth.width = info.width;
    depth.height = info.height;
    depth.encoding = "32FC1";
    depth.step = 4 * info.width;
    depth.data = support::as_bytes(frame.depth);
    color = depth;
    color.encoding = "rgb8";
    color.step = 3 * info.width;
    color.data = frame.color;
  }

  wire::sensor_msgs::CameraInfo info;
  wire::sensor_msgs::Image depth, color;
};

}  // namespace bpa::test
