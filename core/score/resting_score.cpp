// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/resting_score.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/cloud/surface_map.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/model/model_index.hpp"

namespace bpa::score {
namespace {

// Chosen by hand on simulated piles, as all constants of this file.
constexpr float kLowest = -0.05f, kHighest = 0.2f;  // metres: the gap is clamped to them
// Metres: depth cameras see objects and the plane under them up to this much too near or too far
// beside one another, all objects of a frame alike (YCB-Video: 0 to 12 mm).
constexpr float kOffset = tolerance::placed(4);
constexpr int kHullDirections = 64;

// True where the plane is seen in front of the point.
bool beneath(const CheckImage& image, std::span<const Plane> planes, const Eigen::Vector3f& point) {
  const int pixel = image.pixel_of(point);
  if (pixel < 0) return false;
  const CheckPixel& seen = image.pixels[static_cast<std::size_t>(pixel)];
  if (seen.searched || seen.depth <= 0) return false;
  const Eigen::Vector3f observed = point * (seen.depth / point.z());
  const float noise = image.noise(point.z());
  return std::ranges::any_of(planes, [&](const Plane& plane) {
    return plane.height(point) < -tolerance::kBreaks(noise) &&
           std::abs(plane.height(observed)) < tolerance::kApart(noise);
  });
}

// How far a point is inside the convex hull of others, all projected onto the plane, metres.
float inside_hull(const Plane& plane, const std::vector<Eigen::Vector3f>& points,
                  const Eigen::Vector3f& point) {
  const Eigen::Vector3f first = plane.normal.unitOrthogonal(), second = plane.normal.cross(first);
  float least = INFINITY;
  for (int k = 0; k < kHullDirections; ++k) {
    const float angle = static_cast<float>(k * 2 * M_PI / kHullDirections);
    const Eigen::Vector3f direction = std::cos(angle) * first + std::sin(angle) * second;
    float reach = -INFINITY;
    for (const Eigen::Vector3f& p : points) reach = std::max(reach, direction.dot(p - point));
    least = std::min(least, reach);
  }
  return least;
}

}  // namespace

RestingAgreement compare_resting(const CheckImage& image, std::span<const Plane> planes,
                                 const ObjectModel& model, const Pose& camera_from_object) {
  if (planes.empty() || !model.complete) return {};
  const FastPose pose = to_fast(camera_from_object);
  const Plane& table = planes.front();
  std::vector<Eigen::Vector3f> points;
  points.reserve(model.index->check.points.size());
  int below = 0;
  float lowest = INFINITY;
  for (const Eigen::Vector3f& p : model.index->check.points) {
    points.push_back(pose * p);
    below += beneath(image, planes, points.back());
    lowest = std::min(lowest, table.height(points.back()));
  }
  RestingAgreement out;
  out.below = below / std::max(1.0, static_cast<double>(points.size()));
  const float beyond = lowest - std::clamp(lowest, -kOffset, kOffset);
  out.gap = double{std::clamp(beyond, kLowest, kHighest)};
  if (std::abs(lowest) > tolerance::kGoesOn(image.noise(pose.translation.z()))) return out;
  std::erase_if(points, [&](const Eigen::Vector3f& p) {
    return table.height(p) > lowest + tolerance::kInContact;
  });
  const Eigen::Vector3f centre = pose * model.centre.cast<float>();
  out.balance = double{inside_hull(table, points, centre)} / model.diameter;
  return out;
}

}  // namespace bpa::score
