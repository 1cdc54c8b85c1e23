// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/geometry/camera.hpp"

namespace bpa {

/// A rectangle of pixels; empty (width or height 0) means the whole image.
struct RegionOfInterest {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  bool empty() const { return width <= 0 || height <= 0; }
  bool operator==(const RegionOfInterest&) const = default;
};

/// One RGB-D image, depth registered to colour, in the optical frame of its camera.
struct Frame {
  Camera camera;
  std::vector<float> depth;              ///< Row-major, metres along z; 0 where there is none.
  std::vector<std::uint8_t> color;       ///< Row-major rgb, 3 bytes a pixel; empty without colour.
  RegionOfInterest roi;                  ///< Pixels outside are not searched.
  std::vector<std::uint8_t> mask;        ///< Row-major, 0 = do not search; empty = search all.
  std::vector<std::uint8_t> background;  ///< Row-major, 1 = known background (a supporting
                                         ///< surface); empty = the detector finds it.
  std::int64_t stamp_ns = 0;             ///< Exposure time, UTC.
  std::string frame_id;                  ///< Name of the optical frame.
  int fused = 1;  ///< How many frames its depth is made of (frame_fusion.hpp).
};

/// Checks sizes and the camera, and that at least 500 pixels have a depth in (0, 20] m. Names the
/// field, its value and the rule.
Status validate(const Frame& frame);

/// Replaces NaN, infinite, negative and too large (> 20 m) depths by 0. Call before validate when
/// the frame comes from outside.
void clean_depth(Frame& frame);

/// What differs from pixel to pixel of the colour image by more than the noise of a sensor.
enum class ColorContent {
  none,    ///< Nothing: there is no image, or it is of one colour.
  shades,  ///< Light: the image is grey, or of one hue.
  hues,
};
ColorContent color_content(const Frame& frame);

/// Part of a frame, which must lie in it, with the camera that sees it: depth and colour alone.
Frame crop(const Frame& frame, const RegionOfInterest& part);

}  // namespace bpa
