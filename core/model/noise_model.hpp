// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

// A sensor's error on an object (paper section III): standard deviations of range and of normals,
// as sigmoids of two numbers of a viewpoint:
//
//  - the edge distance, across the line of sight: from a surface point to the view's nearest range
//    edge (ModelView::edge_distance).
//  - the surface angle: between the surface normal and the direction to the camera.

namespace bpa {

/// Rises towards edges and grazing angles. All seven are positive. With s the logistic function:
///   sigma(e, a) = floor + edge_height * s((edge_place - e) / edge_width)
///                       + angle_height * s((a - angle_place) / angle_width)
struct NoiseCurve {
  double floor = 0;         ///< Far from edges and seen straight on; unit of the error.
  double edge_height = 0;   ///< What an edge adds; unit of the error.
  double edge_place = 1;    ///< Edge distance at which half of that is left, metres.
  double edge_width = 1;    ///< Metres.
  double angle_height = 0;  ///< What a grazing view adds; unit of the error.
  double angle_place = 1;   ///< Surface angle at which half of that is reached, radians.
  double angle_width = 1;   ///< Radians.

  /// `edge_distance` >= 0 in metres (infinite without edges), `angle` in [0, π/2] radians.
  double operator()(double edge_distance, double angle) const;
};

/// The errors of range and normals that a model predicts.
struct NoiseModel {
  NoiseCurve range;     ///< Metres along the optical axis, at `depth`.
  NoiseCurve normal;    ///< Radians.
  double depth = 0.8;   ///< Of the views it was fitted on, metres.
  bool fitted = false;  ///< False for the usual curves of a Kinect-class sensor, true when they
                        ///< were fitted to views of this object.

  /// Standard deviation of range at another depth, metres: grows as a Kinect's (depth_noise()).
  double range_sigma(double edge_distance, double angle, double depth_m) const;
};

/// The curves of a NoiseModel at a few hundred places, for inner loops.
class NoiseTable {
 public:
  NoiseTable() : NoiseTable(NoiseModel{}) {}
  explicit NoiseTable(const NoiseModel& noise);

  /// Range at NoiseModel::depth, metres; `cosine` of the surface angle, [0, 1].
  float range(float edge_distance, float cosine) const {
    return range_[cell(edge_distance, cosine)];
  }
  /// Radians.
  float normal(float edge_distance, float cosine) const {
    return normal_[cell(edge_distance, cosine)];
  }

 private:
  static constexpr int kEdgeCells = 16, kAngleCells = 32;
  static constexpr float kEdgeCell = 0.002f;  // metres
  static std::size_t cell(float edge_distance, float cosine) {
    const int e = std::clamp(static_cast<int>(edge_distance / kEdgeCell), 0, kEdgeCells - 1);
    const int a = std::clamp(static_cast<int>(cosine * kAngleCells), 0, kAngleCells - 1);
    return static_cast<std::size_t>(e * kAngleCells + a);
  }
  std::array<float, kEdgeCells * kAngleCells> range_, normal_;
};

/// The curves of a Kinect-class sensor over objects of a household: what models have that were not
/// made from views.
NoiseModel usual_noise();

}  // namespace bpa
