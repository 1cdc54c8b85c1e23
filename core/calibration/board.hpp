// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/status.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/pose.hpp"

// Where a camera is by a chessboard that it sees.

namespace bpa::calibration {

/// A chessboard, by its inner corners. One of the two numbers is even and the other odd: then a
/// half turn swaps black and white, and the board has one frame for all cameras.
struct Board {
  int columns = 0;      ///< Inner corners along x, 3 to 50.
  int rows = 0;         ///< Inner corners along y, 3 to 50.
  double square_m = 0;  ///< Edge of a square, metres.
};

/// Names the field, its value and the rule.
Status validate(const Board& board);

struct BoardPose {
  /// Frame of the board: its origin is the inner corner whose square toward the board's middle is
  /// black. x runs along the columns, z out of the board toward the camera.
  Pose camera_from_board;
  double residual_px = 0;  ///< Root mean square distance of corners to their projections, pixels.
};

/// Finds the board in an image (OpenCV's sector-based detector, Duda and Frese 2018) and solves for
/// its pose (IPPE, Collins and Bartoli 2014, then Levenberg-Marquardt). `rgb` is row-major, 3 bytes
/// a pixel, of the camera's size. `distortion` as of camera_info, empty for a rectified image.
/// Fails with invalid_argument on sizes, with not_found where not all corners are seen.
Result<BoardPose> find_board(const std::vector<std::uint8_t>& rgb, const Camera& camera,
                             const std::vector<double>& distortion, const Board& board);

}  // namespace bpa::calibration
