// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdio>
#include <string>

#include <sys/wait.h>

#include "core/cloud/frame.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/eval/pose_errors.hpp"

// Programs that are run as a user would, and a frame of a box over a wall.

namespace bpa::test {

struct Outcome {
  int code = -1;
  std::string out;  // stdout and stderr
};

inline Outcome run(const std::string& arguments, const std::string& program = "bpa") {
  const std::string command =
      std::string(BPA_BINARY_DIR) + "/bin/" + program + " " + arguments + " 2>&1";
  Outcome outcome;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> buffer;
  for (std::size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    outcome.out.append(buffer.data(), n);
  }
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return outcome;
}

inline TriangleMesh box(float x, float y, float z) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back(i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? z : -z);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline constexpr Camera kCamera{160, 120, 140, 140, 79.5, 59.5};

/// A box over a wall, as depth.
inline Frame box_frame(const Pose& camera_from_box) {
  Frame frame;
  frame.camera = kCamera;
  frame.depth = eval::render_depth(box(0.06f, 0.04f, 0.09f), camera_from_box, kCamera);
  for (float& z : frame.depth) {
    if (z == 0) z = 0.9f;
  }
  frame.color.assign(3 * frame.depth.size(), 128);
  return frame;
}

inline Pose box_pose() {
  return {rotation_from_vector({0.7, 0.5, 0.2}), Eigen::Vector3d(0.01, 0.02, 0.6)};
}

}  // namespace bpa::test
