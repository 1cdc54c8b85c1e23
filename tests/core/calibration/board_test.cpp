// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/board.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/geometry/symmetry.hpp"
#include "tests/support/board_image.hpp"
#include "tests/support/solid_scene.hpp"

namespace bpa::calibration {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180;
TEST(FindBoard, AllCamerasFindOneFrame) {
  const Eigen::Vector3d middle(3.5 * test::kBoard.square_m, -2 * test::kBoard.square_m, 0);
  for (const Eigen::Vector3d& eye :
       {Eigen::Vector3d(0, -0.4, 0.5), {0.5, 0, 0.4}, {0.1, 0.45, 0.4}, {-0.35, 0.1, 0.5}}) {
    const Pose truth = test::look_at(middle + eye, middle);
    const auto found = find_board(test::board_image(truth), test::kBoardCamera, {}, test::kBoard);
    ASSERT_TRUE(found.ok()) << found.status().message;
    const PoseError error = pose_error(found->camera_from_board, truth);
    EXPECT_LT(error.position, 0.001) << eye.transpose();
    EXPECT_LT(error.angle, 0.1 * kOneDegree) << eye.transpose();
    EXPECT_LT(found->residual_px, 0.2);
  }
}

TEST(FindBoard, SaysThatThereIsNone) {
  const std::vector<std::uint8_t> grey(3 * 640 * 480, 128);
  const auto found = find_board(grey, test::kBoardCamera, {}, test::kBoard);
  EXPECT_EQ(found.status().code, StatusCode::not_found);
  EXPECT_EQ(found.status().message,
            "the image does not show a chessboard of 8 x 5 inner corners as a whole");
}

TEST(FindBoard, RefusesBoardsThatLookTheSameUpsideDown) {
  EXPECT_TRUE(validate(test::kBoard).ok());
  EXPECT_EQ(validate(Board{9, 7, 0.03}).message,
            "the board has 9 x 7 inner corners; one number must be even and the other odd, else a "
            "half turn of the board looks the same");
  EXPECT_EQ(validate(Board{2, 7, 0.03}).message,
            "the board has 2 columns of inner corners; it must have 3 to 50");
  EXPECT_FALSE(validate(Board{8, 5, 0}).ok());
  EXPECT_EQ(find_board({1, 2, 3}, test::kBoardCamera, {}, test::kBoard).status().code,
            StatusCode::invalid_argument);
}

}  // namespace
}  // namespace bpa::calibration
