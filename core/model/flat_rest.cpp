// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/flat_rest.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/geometry/sphere_directions.hpp"

namespace bpa {
namespace {

constexpr float kHighest = 0.05f;     // metres
constexpr float kFlattest = 0.4f;     // height over length
constexpr int kRestDirections = 400;  // 10 degrees apart
constexpr float kNeighbour = 0.96f;   // cosine, 16 degrees
constexpr float kApart = 0.87f;       // cosine of two rests, 30 degrees
constexpr std::size_t kMostRests = 6;
constexpr float kSilhouetteCell = 0.003f;  // metres

using Points = std::span<const Eigen::Vector3f>;

// How far the object reaches along a direction.
float reach(Points points, const Eigen::Vector3f& direction) {
  float most = -INFINITY;
  for (const Eigen::Vector3f& p : points) most = std::max(most, direction.dot(p));
  return most;
}

// Downhill from `down` to a local minimum of the reach. Of a long object the valleys are narrow:
// many directions are tried.
Eigen::Vector3f settle(Points points, Eigen::Vector3f down) {
  constexpr int kDirections = 64;
  constexpr float kFirstStep = 0.12f, kLastStep = 0.005f;  // radians
  constexpr float kGain = 1e-6f;                           // metres
  float least = reach(points, down);
  for (float step = kFirstStep; step > kLastStep; step *= 0.5f) {
    for (int k = 0, since = 0; since < kDirections; k = (k + 1) % kDirections, ++since) {
      const auto angle = static_cast<float>(k * 2 * M_PI / kDirections);
      const Eigen::Vector3f first = down.unitOrthogonal(), second = down.cross(first);
      const Eigen::Vector3f tilted =
          (down + step * (std::cos(angle) * first + std::sin(angle) * second)).normalized();
      const float height = reach(points, tilted);
      if (height > least - kGain) continue;
      least = height;
      down = tilted;
      since = -1;
    }
  }
  return down;
}

// One point for each cell of the silhouette seen along `up`.
std::vector<Eigen::Vector3f> silhouette(Points points, const Eigen::Vector3f& up) {
  const Eigen::Vector3f first = up.unitOrthogonal(), second = up.cross(first);
  std::set<std::pair<int, int>> met;
  std::vector<Eigen::Vector3f> out;
  for (const Eigen::Vector3f& p : points) {
    const int x = static_cast<int>(std::floor(first.dot(p) / kSilhouetteCell));
    const int y = static_cast<int>(std::floor(second.dot(p) / kSilhouetteCell));
    if (met.insert({x, y}).second) out.push_back(p - up * up.dot(p));
  }
  return out;
}

}  // namespace

FlatExtent flat_extent(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& up) {
  FlatExtent out{Eigen::Vector3f::Zero(), up.unitOrthogonal(), 0, 0};
  if (points.empty()) return out;
  for (const Eigen::Vector3f& p : points) out.middle += p;
  out.middle /= static_cast<float>(points.size());
  const Eigen::Vector3f first = up.unitOrthogonal(), second = up.cross(first);
  Eigen::Matrix2f spread = Eigen::Matrix2f::Zero();
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector2f at(first.dot(p - out.middle), second.dot(p - out.middle));
    spread += at * at.transpose();
  }
  spread /= static_cast<float>(points.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2f> solver(spread);
  out.axis = solver.eigenvectors()(0, 1) * first + solver.eigenvectors()(1, 1) * second;
  // The variance of a uniform length l is l² / 12.
  out.width = std::sqrt(12 * std::max(0.0f, solver.eigenvalues()[0]));
  out.length = std::sqrt(12 * std::max(0.0f, solver.eigenvalues()[1]));
  return out;
}

std::vector<FlatRest> flat_rests(std::span<const Eigen::Vector3f> surface) {
  if (surface.empty()) return {};
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& p : surface) mean += p;
  mean /= static_cast<float>(surface.size());
  std::vector<Eigen::Vector3f> directions;
  for (int i = 0; i < kRestDirections; ++i) {
    directions.push_back(sphere_direction(i, kRestDirections).cast<float>());
  }
  std::vector<Eigen::Vector3f> centred;
  for (const Eigen::Vector3f& p : surface) centred.push_back(p - mean);
  const std::vector<Eigen::Vector3f> hull = outermost(centred, kRestDirections);
  std::vector<float> heights;
  for (const Eigen::Vector3f& direction : directions) heights.push_back(reach(hull, direction));
  std::vector<std::pair<float, Eigen::Vector3f>> stable;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    bool least = heights[i] < kHighest;
    for (std::size_t j = 0; j < directions.size() && least; ++j) {
      least = directions[i].dot(directions[j]) < kNeighbour || heights[i] <= heights[j];
    }
    if (!least) continue;
    const Eigen::Vector3f down = settle(hull, directions[i]);
    if (reach(hull, down) + reach(hull, -down) < kHighest) {
      stable.push_back({reach(hull, down), down});
    }
  }
  std::ranges::stable_sort(stable, {}, &std::pair<float, Eigen::Vector3f>::first);
  std::vector<FlatRest> out;
  for (const auto& [height, down] : stable) {
    const bool known = std::ranges::any_of(
        out, [&toward = down](const FlatRest& rest) { return rest.up.dot(-toward) > kApart; });
    if (known || out.size() >= kMostRests) continue;
    const FlatExtent extent = flat_extent(silhouette(centred, -down), -down);
    if (height + reach(hull, -down) > kFlattest * extent.length) continue;
    out.push_back(
        {-down, extent.axis, mean + extent.middle + height * down, extent.length, extent.width});
  }
  return out;
}

}  // namespace bpa
