// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "core/base/median.hpp"
#include "core/draw/annotate.hpp"

namespace bpa::draw {
namespace {

/// About the distance of neighbouring points: the median over a few of them.
double point_spacing(const std::vector<Eigen::Vector3f>& points) {
  constexpr std::size_t kSamples = 15;
  if (points.size() < 2) return 0.003;
  std::vector<float> nearest;
  for (std::size_t s = 0; s < kSamples; ++s) {
    const std::size_t i = s * (points.size() - 1) / kSamples;
    float best = std::numeric_limits<float>::max();
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (j != i) best = std::min(best, (points[j] - points[i]).squaredNorm());
    }
    nearest.push_back(best);
  }
  return std::sqrt(median(nearest));
}

struct Disc {
  cv::Point centre;
  int radius;
};

std::vector<Disc> seen_discs(const Camera& camera, const PointCloud& surface, const Pose& pose) {
  std::vector<Disc> discs;
  const double spacing = point_spacing(surface.points);
  const Eigen::Matrix3d rotation = pose.matrix();
  for (const Eigen::Vector3f& p : surface.points) {
    const Eigen::Vector3d at = rotation * p.cast<double>() + pose.translation;
    if (!(at.z() > 0.05)) continue;
    const Eigen::Vector2d pixel = camera.project(at);
    if (!camera.contains(pixel.x(), pixel.y())) continue;
    const double radius = std::clamp(0.9 * spacing * camera.fx / at.z(), 1.0, 30.0);
    discs.push_back({{cvRound(pixel.x()), cvRound(pixel.y())}, cvRound(radius)});
  }
  return discs;
}

}  // namespace

Silhouette silhouette(const Camera& camera, const PointCloud& surface,
                      const Pose& camera_from_object) {
  const std::vector<Disc> discs = seen_discs(camera, surface, camera_from_object);
  if (discs.empty()) return {};
  cv::Rect box;
  int largest = 1;
  for (const Disc& disc : discs) {
    box |= cv::Rect(disc.centre, cv::Size(1, 1));
    largest = std::max(largest, disc.radius);
  }
  // Room for what the discs and the closing below reach.
  const int margin = 3 * largest + 2;
  box = cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
        cv::Rect(0, 0, camera.width, camera.height);
  Silhouette out{box.x, box.y, {box.width, box.height, 0}};
  cv::Mat mask(box.height, box.width, CV_8U, out.mask.pixels.data());
  for (const Disc& disc : discs) {
    cv::circle(mask, disc.centre - box.tl(), disc.radius, {255}, cv::FILLED);
  }
  // Discs make the outline too wide by their radius, and bumpy.
  const int size = 2 * discs.back().radius + 1;
  const cv::Mat shape = cv::getStructuringElement(cv::MORPH_ELLIPSE, {size, size});
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, shape);
  cv::erode(mask, mask, shape);
  return out;
}

}  // namespace bpa::draw
