// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/cloud/surface_map.hpp"
#include "core/geometry/fast_pose.hpp"
#include "core/model/model_index.hpp"

namespace bpa {

/// What a pose check reads of one pixel, packed so that a whole image stays in the cache.
struct CheckPixel {
  float depth = 0;                    ///< 0 where there is none.
  std::int8_t normal[3] = {0, 0, 0};  ///< Times 127; zero where unknown.
  std::uint8_t searched = 0;
};

/// The observed surface in the form that pose checks read.
struct CheckImage {
  int width = 0;
  int height = 0;
  float fx = 0, fy = 0, cx = 0, cy = 0;
  std::vector<CheckPixel> pixels;
};

CheckImage make_check_image(const SurfaceMap& map);

/// Counts over the model points that face the camera.
struct PoseCheck {
  int facing = 0;      ///< Inside the image.
  int seen = 0;        ///< Not behind an observed surface.
  int agreeing = 0;    ///< On the observed surface with the same normal, where it is searched.
  int free_space = 0;  ///< Clearly in front of the observed surface: the ray went through.

  /// Larger is better: the agreeing share of what should be seen, with doubt where little is.
  float score() const {
    return static_cast<float>(agreeing - free_space) / static_cast<float>(seen + 6) *
           (static_cast<float>(seen) / static_cast<float>(facing + 1) + 0.5f);
  }
};

/// Tolerances of a check.
struct CheckTolerance {
  float depth = 0.010f;      ///< Metres.
  float free_depth = 0.05f;  ///< Deeper than this in front of the surface is free space
                             ///< (paper section V: 5 cm).
  float normal_cosine = 0.75f;
};

/// Checks up to `count` of the model's points; gives up early (returning few agreeing points) when
/// the first points disagree badly.
PoseCheck check_pose(const CheckImage& image, const CheckPoints& model, const FastPose& pose,
                     int count, const CheckTolerance& tolerance);

}  // namespace bpa
