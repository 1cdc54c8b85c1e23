// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "core/cloud/image.hpp"
#include "core/geometry/pose.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/model/object_model.hpp"
#include "core/score/pose_check.hpp"

namespace bpa::score {

/// What a placement predicts for the pixels of the reduced image: the model's surface as the camera
/// would see it were nothing else there. Only the rectangle that it covers is stored.
struct PredictedSurface {
  int u0 = 0;  ///< Image pixel of the rectangle's first pixel.
  int v0 = 0;
  Image<float> depth;          ///< Metres; 0 where the model is not.
  Image<std::uint32_t> point;  ///< Index into model.surface, where there is a depth.

  /// The predicted depth at a pixel of the image; 0 where the model is not.
  float depth_at(int u, int v) const {
    return depth.contains(u - u0, v - v0) ? depth.at(u - u0, v - v0) : 0;
  }
  /// Calls visit(u, v, depth, point) for every pixel of the image that the model covers, row by
  /// row.
  void for_each(const auto& visit) const {
    for (int y = 0; y < depth.height; ++y) {
      for (int x = 0; x < depth.width; ++x) {
        if (depth.at(x, y) > 0) visit(u0 + x, v0 + y, depth.at(x, y), point.at(x, y));
      }
    }
  }
};

/// Draws the points that the closest of the 66 views sees into a depth buffer. Each is as large as
/// the points' spacing. Empty when the model is out of sight.
PredictedSurface predict_surface(const CheckImage& image, const ObjectModel& model,
                                 const Pose& camera_from_object);

/// The same from all points, hidden by one another as they are at just this pose; slower.
PredictedSurface predict_whole_surface(const CheckImage& image, const ObjectModel& model,
                                       const Pose& camera_from_object);

/// Whether a predicted depth explains what is observed at a pixel of the image.
inline bool explains(const CheckImage& image, int u, int v, float predicted) {
  const float observed = image.depth_at(u, v);
  return observed > 0 &&
         std::abs(observed - predicted) <= tolerance::kOnSurface(image.noise(predicted));
}

/// Whether colours may be those of a surface of this depth: it explains what is observed, or no
/// depth is known. Sensors do not see what is black or shiny, cameras do.
inline bool may_show(const CheckImage& image, int u, int v, float predicted) {
  return image.depth_at(u, v) == 0 || explains(image, u, v, predicted);
}

/// Calls visit(u, v, point) for every pixel that the prediction explains, row by row.
void for_each_explained(const CheckImage& image, const PredictedSurface& predicted,
                        const auto& visit) {
  predicted.for_each([&](int u, int v, float z, std::uint32_t point) {
    if (explains(image, u, v, z)) visit(u, v, point);
  });
}

/// The observed point at a pixel, in the camera's frame.
inline Eigen::Vector3f observed_point(const CheckImage& image, int u, int v) {
  const float z = image.depth_at(u, v);
  return {(static_cast<float>(u) - image.cx) / image.fx * z,
          (static_cast<float>(v) - image.cy) / image.fy * z, z};
}

}  // namespace bpa::score
