// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/rim_points.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/parallel.hpp"
#include "core/features/pair_voting.hpp"

namespace bpa::features {
namespace {

using Look = std::function<Beside(const Eigen::Vector3f&, const Eigen::Vector3f&)>;

// Chosen by hand.
constexpr int kDirections = 16, kSteps = 5;
constexpr float kStep = 0.004f;  // metres
// Directions in which the surface ends. A point with more of them has no surface around it.
constexpr int kMinEnds = 3, kMaxEnds = 9;

// How far the surface goes on in a direction, metres; nothing if no end is seen. Depth is often
// unknown just beyond a range edge: then the surface ends where it is last seen.
std::optional<float> distance_to_end(const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
                                     const Eigen::Vector3f& direction, const Look& look) {
  float seen = 0;
  for (int step = 1; step <= kSteps; ++step) {
    const float distance = kStep * static_cast<float>(step);
    switch (look(point + distance * direction, normal)) {
      case Beside::surface:
        seen = distance;
        break;
      case Beside::end:
        return seen + 0.5f * kStep;
      case Beside::hidden:
        return {};
      case Beside::unknown:
        break;
    }
  }
  return {};
}

// Cosine and sine of each direction.
std::array<std::pair<float, float>, kDirections> circle() {
  std::array<std::pair<float, float>, kDirections> out;
  for (int k = 0; k < kDirections; ++k) {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(k) / kDirections;
    out[k] = {std::cos(angle), std::sin(angle)};
  }
  return out;
}

std::optional<RimPoint> rim_beside(const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
                                   const Look& look) {
  const Eigen::Matrix3f basis = basis_of(normal);
  std::vector<Eigen::Vector3f> ends;
  Eigen::Vector3f outward = Eigen::Vector3f::Zero();
  static const auto kCirclePoints = circle();
  for (const auto& [cosine, sine] : kCirclePoints) {
    const Eigen::Vector3f direction = cosine * basis.col(0) + sine * basis.col(1);
    const auto distance = distance_to_end(point, normal, direction, look);
    if (!distance) continue;
    ends.push_back(*distance * direction);
    outward += direction;
  }
  const int count = static_cast<int>(ends.size());
  constexpr float kNoDirection = 1e-3f;
  if (count < kMinEnds || count > kMaxEnds || outward.norm() < kNoDirection) return {};
  outward.normalize();
  float distance = 0;
  for (const Eigen::Vector3f& end : ends) distance += end.dot(outward) / static_cast<float>(count);
  return RimPoint{point + distance * outward, normal, outward};
}

}  // namespace

std::vector<RimPoint> find_rims(const PointCloud& points, const Look& look, int num_threads) {
  std::vector<std::optional<RimPoint>> rims(points.size());
  parallel_for(points.size(), num_threads, [&](std::size_t i) {
    rims[i] = rim_beside(points.points[i], points.normals[i], look);
  });
  std::vector<RimPoint> out;
  for (const auto& rim : rims) {
    if (rim) out.push_back(*rim);
  }
  return out;
}

}  // namespace bpa::features
