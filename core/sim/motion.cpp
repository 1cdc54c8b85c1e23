// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/random.hpp"
#include "core/sim/scenes.hpp"

namespace bpa::sim {
namespace {

constexpr double kLongest = 60;  // seconds that an orbit is limited over

struct Speeds {
  double linear = 0, angular = 0;  // the largest
};

Speeds largest_speeds(const PosePath& path, double length, int steps) {
  Speeds speeds;
  const double step = length / steps;
  Pose last = path(0);
  for (int i = 1; i <= steps; ++i) {
    const Pose pose = path(i * step);
    const PoseError change = pose_error(last, pose);
    speeds.linear = std::max(speeds.linear, change.position / step);
    speeds.angular = std::max(speeds.angular, change.angle / step);
    last = pose;
  }
  return speeds;
}

}  // namespace

double smooth_start_and_stop(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10 + u * (6 * u - 15));
}

double smooth_bump(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return std::pow(4 * u * (1 - u), 3);
}

double seconds_of(const PosePath& path, const SpeedLimits& limits) {
  const Speeds speeds = largest_speeds(path, 1, 500);
  return std::max(speeds.linear / limits.linear, speeds.angular / limits.angular);
}

double Orbit::Wave::at(double seconds) const {
  return middle + amplitude * std::sin(frequency * seconds + phase);
}

Orbit::Orbit(const OrbitRanges& ranges, const SpeedLimits& limits, std::uint64_t seed) {
  RandomStream random(seed, 0);
  const auto draw_wave = [&random](double middle, double amplitude) {
    const double frequency = random.uniform(0.9, 2);
    return Wave{middle, amplitude, frequency, random.uniform(0, 2 * std::numbers::pi)};
  };
  const auto draw_within = [&](double low, double high) {
    const double amplitude = 0.5 * (high - low) * random.uniform(0.3, 0.9);
    return draw_wave(random.uniform(low + amplitude, high - amplitude), amplitude);
  };
  const double azimuth_amplitude = random.uniform(0.5, 1.2);
  azimuth_ = draw_wave(random.uniform(0, 2 * std::numbers::pi), azimuth_amplitude);
  elevation_ = draw_within(ranges.min_elevation, ranges.max_elevation);
  distance_ = draw_within(ranges.min_distance, ranges.max_distance);
  roll_ = draw_wave(0, random.uniform(0.05, 0.35));
  target_x_ = draw_wave(0, random.uniform(0, 0.06));
  target_y_ = draw_wave(0, random.uniform(0, 0.06));
  const double share = random.uniform(0.6, 0.97);
  const Speeds speeds = largest_speeds([this](double t) { return at(t); }, kLongest, 6000);
  scale_ = share * std::min({limits.linear / speeds.linear, limits.angular / speeds.angular, 1.0});
}

Pose Orbit::at(double unscaled) const {
  const Eigen::Vector3d target(target_x_.at(unscaled), target_y_.at(unscaled), 0.05);
  return camera_looking_at(target, distance_.at(unscaled), elevation_.at(unscaled),
                           azimuth_.at(unscaled), roll_.at(unscaled));
}

Pose Orbit::world_from_camera(double seconds) const { return at(scale_ * seconds); }

}  // namespace bpa::sim
