// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/draw/poses.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "core/draw/canvas.hpp"
#include "core/draw/sheet.hpp"

namespace bpa::draw {
namespace {

constexpr double kDim = 0.55, kPale = 0.7;  // brightness, and how much of the colour is gone
constexpr double kFaintest = 0.35;          // brightness of the last of several poses
constexpr std::size_t kDash = 10;           // pixels, and as many between dashes

Camera enlarged(const Camera& camera, double factor) {
  return {cvRound(factor * camera.width),
          cvRound(factor * camera.height),
          factor * camera.fx,
          factor * camera.fy,
          factor * (camera.cx + 0.5) - 0.5,  // (0, 0) is the middle of a pixel
          factor * (camera.cy + 0.5) - 0.5};
}

cv::Mat canvas_of(const Frame& frame, const Camera& camera, bool dimmed) {
  cv::Mat image = to_mat(objects(frame, {}));
  if (dimmed) {
    cv::Mat grey;
    cv::cvtColor(image, grey, cv::COLOR_RGB2GRAY);
    cv::cvtColor(grey, grey, cv::COLOR_GRAY2RGB);
    cv::addWeighted(image, kDim * (1 - kPale), grey, kDim * kPale, 0, image);
  }
  cv::Mat canvas;
  cv::resize(image, canvas, {camera.width, camera.height}, 0, 0, cv::INTER_CUBIC);
  return canvas;
}

cv::Scalar shade(const DrawnPoses& group, std::size_t i) {
  const bool ranked =
      group.style == DrawnPoses::Style::outlines || group.style == DrawnPoses::Style::dots;
  const double place = static_cast<double>(i) / static_cast<double>(group.poses.size());
  const double bright = ranked ? 1 - (1 - kFaintest) * place : 1;
  return {bright * group.color[0], bright * group.color[1], bright * group.color[2]};
}

void draw_dashes(cv::Mat& canvas, const std::vector<cv::Point>& contour, const cv::Scalar& color) {
  for (std::size_t i = 0; i + 1 < contour.size(); ++i) {
    if (i / kDash % 2 == 0) cv::line(canvas, contour[i], contour[i + 1], color, 2, cv::LINE_AA);
  }
}

void draw_outline(cv::Mat& canvas, const Camera& camera, const ObjectModel& model,
                  const FastPose& pose, const cv::Scalar& color, DrawnPoses::Style style) {
  Silhouette shape = silhouette(camera, model.surface, to_pose(pose));
  if (shape.mask.empty()) return;
  const cv::Mat mask(shape.mask.height, shape.mask.width, CV_8U, shape.mask.pixels.data());
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE, {shape.left, shape.top});
  if (style == DrawnPoses::Style::dashed) {
    for (const auto& contour : contours) draw_dashes(canvas, contour, color);
    return;
  }
  const int thickness = style == DrawnPoses::Style::bold ? 2 : 1;
  cv::drawContours(canvas, contours, -1, color, thickness, cv::LINE_AA);
}

void draw_dot(cv::Mat& canvas, const Camera& camera, const Eigen::Vector3d& at,
              const cv::Scalar& color) {
  if (!(at.z() > 0.05)) return;
  const Eigen::Vector2d pixel = camera.project(at);
  if (!camera.contains(pixel.x(), pixel.y())) return;
  cv::circle(canvas, {cvRound(pixel.x()), cvRound(pixel.y())}, 2, color, cv::FILLED, cv::LINE_AA);
}

constexpr int kView = 640, kViewRows = 480;  // pixels of each of two views of one pose
constexpr Rgb kPlaced{80, 255, 120}, kTrue{255, 255, 255};

io::ColorImage view(const Frame& frame, const ObjectModel& model, const Pose& pose,
                    const std::vector<Pose>& truths) {
  std::vector<FastPose> true_poses;
  for (const Pose& truth : truths) true_poses.push_back(to_fast(truth));
  const FastPose placed = to_fast(pose);
  const io::ColorImage picture = poses(frame, model,
                                       {{{&placed, 1}, kPlaced, DrawnPoses::Style::bold},
                                        {true_poses, kTrue, DrawnPoses::Style::dashed}},
                                       {kView, false});
  cv::Mat out;
  cv::resize(to_mat(picture), out, {kView, kViewRows}, 0, 0, cv::INTER_AREA);
  return to_image(out);
}

// The surroundings of a pose, of the shape of a view.
RegionOfInterest surroundings(const Camera& camera, const ObjectModel& model, const Pose& pose) {
  const Silhouette shape = silhouette(camera, model.surface, pose);
  if (shape.mask.empty()) return {0, 0, camera.width, camera.height};
  const int height =
      std::min({camera.height, camera.width * kViewRows / kView,
                std::max(3 * shape.mask.height / 2, 3 * shape.mask.width * kViewRows / kView / 2)});
  const int width = height * kView / kViewRows;
  const int u = shape.left + shape.mask.width / 2 - width / 2;
  const int v = shape.top + shape.mask.height / 2 - height / 2;
  return {std::clamp(u, 0, camera.width - width), std::clamp(v, 0, camera.height - height), width,
          height};
}

}  // namespace

io::ColorImage poses(const Frame& frame, const ObjectModel& model,
                     const std::vector<DrawnPoses>& groups, const DrawPosesOptions& options) {
  const double factor = std::max(1.0, static_cast<double>(options.min_width) / frame.camera.width);
  const Camera camera = enlarged(frame.camera, factor);
  cv::Mat canvas = canvas_of(frame, camera, options.dimmed);
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& p : model.surface.points) middle += p;
  middle /= static_cast<float>(std::max<std::size_t>(1, model.surface.size()));
  for (const DrawnPoses& group : groups) {
    for (std::size_t i = group.poses.size(); i-- > 0;) {
      const FastPose& pose = group.poses[i];
      const cv::Scalar color = shade(group, i);
      if (group.style == DrawnPoses::Style::dots) {
        draw_dot(canvas, camera, Eigen::Vector3f(pose * middle).cast<double>(), color);
      } else {
        draw_outline(canvas, camera, model, pose, color, group.style);
      }
    }
  }
  return to_image(canvas);
}

io::ColorImage pose_from_near(const Frame& frame, const ObjectModel& model, const Pose& pose,
                              const std::vector<Pose>& truths) {
  const Frame near = crop(frame, surroundings(frame.camera, model, pose));
  return beside(view(frame, model, pose, truths), view(near, model, pose, truths));
}

}  // namespace bpa::draw
