// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/noise_model.hpp"

#include <cmath>

#include "core/cloud/surface_map.hpp"

namespace bpa {
namespace {

double logistic(double x) { return 1 / (1 + std::exp(-x)); }

}  // namespace

double NoiseCurve::operator()(double edge_distance, double angle) const {
  return floor + edge_height * logistic((edge_place - edge_distance) / edge_width) +
         angle_height * logistic((angle - angle_place) / angle_width);
}

double NoiseModel::range_sigma(double edge_distance, double angle, double depth_m) const {
  const auto sensor = [](double z) {
    return static_cast<double>(depth_noise(static_cast<float>(z)));
  };
  return range(edge_distance, angle) * sensor(depth_m) / sensor(depth);
}

NoiseTable::NoiseTable(const NoiseModel& noise) {
  for (int e = 0; e < kEdgeCells; ++e) {
    for (int a = 0; a < kAngleCells; ++a) {
      const double edge_distance = (e + 0.5) * static_cast<double>(kEdgeCell);
      const double angle = std::acos((a + 0.5) / kAngleCells);
      const int i = e * kAngleCells + a;
      range_[i] = static_cast<float>(noise.range(edge_distance, angle));
      normal_[i] = static_cast<float>(noise.normal(edge_distance, angle));
    }
  }
}

NoiseModel usual_noise() {
  NoiseModel noise;
  noise.depth = 0.78;
  noise.range = {0.0013, 0.0005, 0.004, 0.003, 0.010, 1.33, 0.10};
  noise.normal = {0.13, 0.8, 0.0015, 0.004, 0.8, 1.39, 0.05};
  return noise;
}

}  // namespace bpa
