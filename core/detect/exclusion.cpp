// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/exclusion.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/geometry/tolerance.hpp"
#include "core/model/model_index.hpp"

namespace bpa::detect {
namespace {

// Points of a model that decide; a fair sample (CheckPoints).
std::span<const Eigen::Vector3f> sample_of(const ObjectModel& model) {
  constexpr std::size_t kPoints = 48;
  const std::vector<Eigen::Vector3f>& points = model.index->check.points;
  return std::span(points).first(std::min(points.size(), kPoints));
}

// The smallest side of the model's box, metres.
double thickness(const ObjectModel& model) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : sample_of(model)) box.extend(point);
  return static_cast<double>(box.sizes().minCoeff());
}

// The share of a's surface that lies clearly inside of b. A hollow is not inside.
double share_inside(const Candidate& a, const Candidate& b) {
  const auto points = sample_of(*a.model);
  const FastPose a_in_b = to_fast(b.pose().inverse() * a.pose());
  const PointCloud& surface = b.model->surface;
  int inside = 0;
  for (const Eigen::Vector3f& of_a : points) {
    const Eigen::Vector3f point = a_in_b * of_a;
    const int nearest = b.model->index->distances.nearest_to(point);
    if (nearest < 0) continue;
    inside += (point - surface.points[nearest]).dot(surface.normals[nearest]) < -tolerance::kInside;
  }
  return points.empty() ? 0 : inside / static_cast<double>(points.size());
}

}  // namespace

int common_pixels(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second) {
  int common = 0;
  for (auto i = first.begin(), j = second.begin(); i != first.end() && j != second.end();) {
    if (*i == *j)
      ++common, ++i, ++j;
    else if (*i < *j)
      ++i;
    else
      ++j;
  }
  return common;
}

bool exclude(const Candidate& a, const Candidate& b, int common) {
  const auto smaller = static_cast<double>(std::min(a.explained.size(), b.explained.size()));
  return common > kMaxShared * smaller || collide(a, b);
}

bool collide(const Candidate& a, const Candidate& b) {
  constexpr double kMaxInside = 0.1;
  const double distance = (a.place() - b.place()).norm();
  const double smaller = std::min(a.model->diameter, b.model->diameter);
  // A model that was seen from all sides has an inside.
  const auto is_solid = [](const Candidate& c) { return c.model->complete && c.model->index; };
  const bool solid = is_solid(a) && is_solid(b);
  if (a.model == b.model && distance < tolerance::kSamePlace * smaller) {
    if (!solid) return true;
    const double thick = thickness(*a.model);
    if (thick < 2 * tolerance::kInside || distance < 0.5 * thick) return true;
  }
  if (!solid) return distance < tolerance::kOthersPlace * smaller;
  if (distance > 0.5 * (a.model->diameter + b.model->diameter)) return false;
  return share_inside(a, b) > kMaxInside || share_inside(b, a) > kMaxInside;
}

}  // namespace bpa::detect
