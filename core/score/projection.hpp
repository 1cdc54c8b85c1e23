// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "core/geometry/pose.hpp"
#include "core/observation/check_image.hpp"

namespace bpa::score {

struct Coordinates {
  float x, y, z;
};

/// A pose and a camera as plain numbers, for loops that become vectors.
class Projection {
 public:
  Projection(const CheckImage& image, const FastPose& pose)
      : tx_(pose.translation.x()),
        ty_(pose.translation.y()),
        tz_(pose.translation.z()),
        fx_(image.fx),
        fy_(image.fy),
        cx_(image.cx + 0.5f),
        cy_(image.cy + 0.5f),
        right_(static_cast<float>(image.width)),
        bottom_(static_cast<float>(image.height)),
        width_(image.width) {
    std::copy_n(pose.rotation.data(), 9, r_);
  }
  /// To the camera frame: of a direction, and of a point.
  Coordinates turned(float x, float y, float z) const {
    return {r_[0] * x + r_[3] * y + r_[6] * z, r_[1] * x + r_[4] * y + r_[7] * z,
            r_[2] * x + r_[5] * y + r_[8] * z};
  }
  Coordinates moved(float x, float y, float z) const {
    const Coordinates p = turned(x, y, z);
    return {p.x + tx_, p.y + ty_, p.z + tz_};
  }
  /// -1 outside the image, or where not `shown`.
  int pixel_of(const Coordinates& p, bool shown) const {
    return pixel_at(fx_ * p.x / p.z + cx_, fy_ * p.y / p.z + cy_, shown & (p.z > kNearest_m));
  }
  /// The same with one division, which rounds otherwise.
  int pixel_by_inverse(const Coordinates& p, bool shown) const {
    const float inverse_z = 1 / p.z;
    return pixel_at(fx_ * p.x * inverse_z + cx_, fy_ * p.y * inverse_z + cy_,
                    shown & (p.z > kNearest_m));
  }

 private:
  int pixel_at(float u, float v, bool shown) const {
    const bool inside = shown & (u >= 0) & (v >= 0) & (u < right_) & (v < bottom_);
    // Of points outside, numbers that an int holds.
    const int column = static_cast<int>(inside ? u : 0), row = static_cast<int>(inside ? v : 0);
    return inside ? row * width_ + column : -1;
  }

  float r_[9];  // column by column
  float tx_, ty_, tz_, fx_, fy_, cx_, cy_, right_, bottom_;
  int width_;
};

}  // namespace bpa::score
