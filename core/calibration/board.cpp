// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/board.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base/concat.hpp"
#include "core/base/guarded.hpp"

namespace bpa::calibration {
namespace {

using Corners = std::vector<cv::Point2f>;  // row by row

cv::Point2f at(const Corners& corners, const Board& board, int column, int row) {
  return corners[static_cast<std::size_t>(row * board.columns + column)];
}

// Mean light of the squares between four corners whose column and row sum to an even number, less
// that of the others.
double even_less_odd(const cv::Mat& gray, const Corners& corners, const Board& board) {
  double sums[2] = {0, 0};
  int counts[2] = {0, 0};
  for (int row = 0; row + 1 < board.rows; ++row) {
    for (int column = 0; column + 1 < board.columns; ++column) {
      const cv::Point2f middle =
          0.25F * (at(corners, board, column, row) + at(corners, board, column + 1, row) +
                   at(corners, board, column, row + 1) + at(corners, board, column + 1, row + 1));
      const int u = std::clamp(static_cast<int>(std::lround(middle.x)), 0, gray.cols - 1);
      const int v = std::clamp(static_cast<int>(std::lround(middle.y)), 0, gray.rows - 1);
      const int parity = (row + column) % 2;
      sums[parity] += gray.at<std::uint8_t>(v, u);
      ++counts[parity];
    }
  }
  return sums[0] / std::max(1, counts[0]) - sums[1] / std::max(1, counts[1]);
}

// Puts the corners into the one order that the board has for all cameras.
void order(const cv::Mat& gray, const Board& board, Corners& corners) {
  const cv::Point2f x = at(corners, board, board.columns - 1, 0) - at(corners, board, 0, 0);
  const cv::Point2f y = at(corners, board, 0, board.rows - 1) - at(corners, board, 0, 0);
  if (x.x * y.y - x.y * y.x < 0) {  // a mirror image: rows run the other way
    for (int row = 0; row < board.rows; ++row) {
      const auto first = corners.begin() + static_cast<std::ptrdiff_t>(row) * board.columns;
      std::reverse(first, first + board.columns);
    }
  }
  if (even_less_odd(gray, corners, board) > 0) std::reverse(corners.begin(), corners.end());
}

// Moves each corner to where the gradients about it meet (Foerstner and Guelch 1987). The detector
// alone is off by 0.2 pixels on rendered boards.
void refine(const cv::Mat& gray, const Board& board, Corners& corners) {
  double spacing = gray.cols;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const cv::Point2f corner = at(corners, board, column, row);
      if (column > 0) {
        spacing = std::min(spacing, cv::norm(corner - at(corners, board, column - 1, row)));
      }
      if (row > 0)
        spacing = std::min(spacing, cv::norm(corner - at(corners, board, column, row - 1)));
    }
  }
  constexpr double kShareOfSquare = 0.4;  // of a square, so that no other corner is near
  constexpr int kMostHalf = 8, kIterations = 40;
  constexpr double kStep = 0.001;  // pixels
  const int half = std::clamp(static_cast<int>(kShareOfSquare * spacing), 2, kMostHalf);
  cv::cornerSubPix(gray, corners, {half, half}, {-1, -1},
                   {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, kIterations, kStep});
}

Pose pose_from(const cv::Vec3d& rotation, const cv::Vec3d& translation) {
  return {rotation_from_vector({rotation[0], rotation[1], rotation[2]}),
          {translation[0], translation[1], translation[2]}};
}

}  // namespace

Status validate(const Board& board) {
  constexpr int kFewest = 3, kMost = 50;
  for (const auto& [name, count] : {std::pair{"columns", board.columns}, {"rows", board.rows}}) {
    if (count >= kFewest && count <= kMost) continue;
    return invalid_argument("the board has ", count, " ", name, " of inner corners; it must have ",
                            kFewest, " to ", kMost);
  }
  if ((board.columns + board.rows) % 2 == 0) {
    return invalid_argument("the board has ", board.columns, " x ", board.rows,
                            " inner corners; one number must be even and the other odd, else a "
                            "half turn of the board looks the same");
  }
  if (!(board.square_m > 0) || !std::isfinite(board.square_m)) {
    return invalid_argument("the board's squares are ", board.square_m,
                            " m wide; that must be positive");
  }
  return {};
}

static Result<BoardPose> find(const std::vector<std::uint8_t>& rgb, const Camera& camera,
                              const std::vector<double>& distortion, const Board& board) {
  if (Status status = validate(board); !status.ok()) return status;
  if (Status status = validate(camera); !status.ok()) return status;
  const auto pixels = static_cast<std::size_t>(camera.width) * camera.height;
  if (rgb.size() != 3 * pixels) {
    return invalid_argument("the image has ", rgb.size(), " bytes; it must have 3 for each of ",
                            camera.width, " x ", camera.height, " pixels");
  }
  const cv::Mat color(camera.height, camera.width, CV_8UC3, const_cast<std::uint8_t*>(rgb.data()));
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_RGB2GRAY);
  Corners corners;
  const int flags = cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY | cv::CALIB_CB_NORMALIZE_IMAGE;
  if (!cv::findChessboardCornersSB(gray, {board.columns, board.rows}, corners, flags)) {
    return not_found("the image does not show a chessboard of ", board.columns, " x ", board.rows,
                     " inner corners as a whole");
  }
  order(gray, board, corners);
  refine(gray, board, corners);
  std::vector<cv::Point3d> points;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      points.emplace_back(column * board.square_m, -row * board.square_m, 0);
    }
  }
  const cv::Matx33d intrinsics(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::Vec3d rotation, translation;
  const bool solved = cv::solvePnP(points, corners, intrinsics, distortion, rotation, translation,
                                   false, cv::SOLVEPNP_IPPE);
  if (!solved) return not_found("the corners of the chessboard have no pose: they lie on one line");
  cv::solvePnPRefineLM(points, corners, intrinsics, distortion, rotation, translation);
  std::vector<cv::Point2d> projected;
  cv::projectPoints(points, rotation, translation, intrinsics, distortion, projected);
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const cv::Point2d offset = cv::Point2d(corners[i]) - projected[i];
    sum += offset.dot(offset);
  }
  return BoardPose{pose_from(rotation, translation),
                   std::sqrt(sum / static_cast<double>(corners.size()))};
}

Result<BoardPose> find_board(const std::vector<std::uint8_t>& rgb, const Camera& camera,
                             const std::vector<double>& distortion, const Board& board) {
  return guarded("finding the chessboard", [&] { return find(rgb, camera, distortion, board); });
}

}  // namespace bpa::calibration
