// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/cloud/point_cloud.hpp"
#include "idl/wire/cdr.hpp"
#include "idl/wire/messages.hpp"

// A frame that shows one object, and frames and results as messages, for tests that compare answers
// to the bit.

namespace bpa::support {

namespace msgs = wire::bpa_msgs;

inline std::vector<std::uint8_t> bits(msgs::SceneInterpretations message) {
  message.stage_timings.clear();  // the clock is allowed to differ
  message.total_ms = 0;
  std::vector<std::uint8_t> bytes(wire::encoded_size(message));
  wire::encode(message, bytes.data(), bytes.size());
  return bytes;
}

inline msgs::RgbdFrame message_of(const Frame& frame) {
  msgs::RgbdFrame message;
  message.header = {wire::builtin_interfaces::from_ns(frame.stamp_ns), frame.frame_id};
  message.width = static_cast<std::uint32_t>(frame.camera.width);
  message.height = static_cast<std::uint32_t>(frame.camera.height);
  if (!frame.color.empty()) message.color_encoding = "rgb8";
  message.color = frame.color;
  message.depth_encoding = "32FC1";
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(frame.depth.data());
  message.depth.assign(bytes, bytes + frame.depth.size() * sizeof(float));
  const Camera& c = frame.camera;
  message.k = {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
  return message;
}

/// A box of 60 x 90 x 40 mm with a smaller one on top.
inline TriangleMesh stepped_box() {
  TriangleMesh mesh;
  const auto add_box = [&mesh](const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int i = 0; i < 8; ++i) {
      mesh.vertices.emplace_back((i & 1) != 0 ? high.x() : low.x(),
                                 (i & 2) != 0 ? high.y() : low.y(),
                                 (i & 4) != 0 ? high.z() : low.z());
    }
    const std::uint32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : faces) {
      mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
      mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
    }
  };
  add_box({-0.03f, -0.045f, -0.02f}, {0.03f, 0.045f, 0.02f});
  add_box({-0.03f, -0.045f, 0.02f}, {0.0f, 0.0f, 0.05f});
  return mesh;
}

/// The stepped box seen from above, straight on, on a wall 0.6 m away.
inline Frame box_frame() {
  Frame frame;
  frame.camera = {160, 120, 150, 150, 79.5, 59.5};
  frame.stamp_ns = 1'234'567'891;
  frame.frame_id = "box_camera";
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      const auto inside = [&](double z, double x0, double x1, double y0, double y1) {
        const Eigen::Vector3d p = frame.camera.unproject(u, v, z);
        return p.x() >= x0 && p.x() <= x1 && p.y() >= y0 && p.y() <= y1;
      };
      double z = 0.6;
      if (inside(0.56, -0.03, 0.03, -0.045, 0.045)) z = 0.56;
      if (inside(0.53, -0.03, 0.0, 0.0, 0.045)) z = 0.53;
      frame.depth.push_back(static_cast<float>(z));
    }
  }
  frame.color.assign(3 * frame.depth.size(), 128);
  return frame;
}

}  // namespace bpa::support
