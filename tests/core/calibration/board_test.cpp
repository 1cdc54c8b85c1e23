// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/board.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/geometry/symmetry.hpp"
#include "tests/support/solid_scene.hpp"

namespace bpa {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180;
const Board kBoard{8, 5, 0.03};
const Camera kCamera{640, 480, 525, 525, 319.5, 239.5};

// Light of a point of the board's plane: a white border about squares, of which the one between the
// first four corners is black. Rows of corners go toward negative y.
double light(double x, double y) {
  const int column = static_cast<int>(std::floor(x / kBoard.square_m));
  const int row = static_cast<int>(std::floor(-y / kBoard.square_m));
  const bool on_board = column >= -1 && column < kBoard.columns && row >= -1 && row < kBoard.rows;
  if (!on_board) return 0.8;
  return (column + row) % 2 == 0 ? 0.1 : 0.9;
}

// The board as a pinhole camera sees it: the mean of 4 x 4 rays a pixel, each met with the plane.
std::vector<std::uint8_t> seen(const Pose& camera_from_board) {
  const Pose board_from_camera = camera_from_board.inverse();
  std::vector<std::uint8_t> rgb;
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      double sum = 0;
      for (int k = 0; k < 16; ++k) {
        const double du = (k % 4 - 1.5) / 4, dv = (k / 4 - 1.5) / 4;
        const Eigen::Vector3d ray =
            board_from_camera.rotation * kCamera.unproject(u + du, v + dv, 1);
        const Eigen::Vector3d& eye = board_from_camera.translation;
        const double t = -eye.z() / ray.z();
        sum += light(eye.x() + t * ray.x(), eye.y() + t * ray.y()) / 16;
      }
      rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(std::lround(255 * sum)));
    }
  }
  return rgb;
}

TEST(FindBoard, AllCamerasFindOneFrame) {
  const Eigen::Vector3d middle(3.5 * kBoard.square_m, -2 * kBoard.square_m, 0);
  for (const Eigen::Vector3d& eye :
       {Eigen::Vector3d(0, -0.4, 0.5), {0.5, 0, 0.4}, {0.1, 0.45, 0.4}, {-0.35, 0.1, 0.5}}) {
    const Pose truth = test::look_at(middle + eye, middle);
    const auto found = find_board(seen(truth), kCamera, {}, kBoard);
    ASSERT_TRUE(found.ok()) << found.status().message;
    const PoseError error = pose_error(found->camera_from_board, truth);
    EXPECT_LT(error.position, 0.001) << eye.transpose();
    EXPECT_LT(error.angle, 0.1 * kOneDegree) << eye.transpose();
    EXPECT_LT(found->residual_px, 0.2);
  }
}

TEST(FindBoard, SaysThatThereIsNone) {
  const std::vector<std::uint8_t> grey(3 * 640 * 480, 128);
  const auto found = find_board(grey, kCamera, {}, kBoard);
  EXPECT_EQ(found.status().code, StatusCode::not_found);
  EXPECT_EQ(found.status().message,
            "the image does not show a chessboard of 8 x 5 inner corners as a whole");
}

TEST(FindBoard, RefusesBoardsThatLookTheSameUpsideDown) {
  EXPECT_TRUE(validate(kBoard).ok());
  EXPECT_EQ(validate(Board{9, 7, 0.03}).message,
            "the board has 9 x 7 inner corners; one number must be even and the other odd, else a "
            "half turn of the board looks the same");
  EXPECT_EQ(validate(Board{2, 7, 0.03}).message,
            "the board has 2 columns of inner corners; it must have 3 to 50");
  EXPECT_FALSE(validate(Board{8, 5, 0}).ok());
  EXPECT_EQ(find_board({1, 2, 3}, kCamera, {}, kBoard).status().code, StatusCode::invalid_argument);
}

}  // namespace
}  // namespace bpa
