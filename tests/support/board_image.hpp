// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/calibration/board.hpp"

// A chessboard as a pinhole camera sees it, by exact intersection of rays with its plane.

namespace bpa::test {

inline const calibration::Board kBoard{8, 5, 0.03};
inline const Camera kBoardCamera{640, 480, 525, 525, 319.5, 239.5};

/// Light of a point of the board's plane: a white border about squares, of which the one between
/// the first four corners is black. Rows of corners go toward negative y.
inline double board_light(double x, double y) {
  const int column = static_cast<int>(std::floor(x / kBoard.square_m));
  const int row = static_cast<int>(std::floor(-y / kBoard.square_m));
  const bool on_board = column >= -1 && column < kBoard.columns && row >= -1 && row < kBoard.rows;
  if (!on_board) return 0.8;
  return (column + row) % 2 == 0 ? 0.1 : 0.9;
}

/// The board as a pinhole camera sees it: the mean of 4 x 4 rays a pixel, each met with the plane.
inline std::vector<std::uint8_t> board_image(const Pose& camera_from_board) {
  const Pose board_from_camera = camera_from_board.inverse();
  std::vector<std::uint8_t> rgb;
  for (int v = 0; v < kBoardCamera.height; ++v) {
    for (int u = 0; u < kBoardCamera.width; ++u) {
      double sum = 0;
      for (int k = 0; k < 16; ++k) {
        const double du = (k % 4 - 1.5) / 4, dv = (k / 4 - 1.5) / 4;
        const Eigen::Vector3d ray =
            board_from_camera.rotation * kBoardCamera.unproject(u + du, v + dv, 1);
        const Eigen::Vector3d& eye = board_from_camera.translation;
        const double t = -eye.z() / ray.z();
        sum += board_light(eye.x() + t * ray.x(), eye.y() + t * ray.y()) / 16;
      }
      rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(std::lround(255 * sum)));
    }
  }
  return rgb;
}

}  // namespace bpa::test
