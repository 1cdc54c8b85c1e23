// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/base/options.hpp"
#include "core/cloud/image.hpp"

namespace bpa {

/// The defaults are chosen by hand.
struct ImageEdgeOptions {
  double blur_px = 0.8;
  double low = 10;
  double high = 25;
  int num_threads = 0;  ///< 0: one for each core.

  template <class Visitor>
  void visit_fields(Visitor&& visit) {
    visit("blur_px", blur_px,
          FieldRule{0, 10, "Standard deviation of the blur before gradients, pixels."});
    visit("low", low,
          FieldRule{0, 255, "Step of luminance (of 255) that continues an image edge."});
    visit("high", high, FieldRule{0, 255, "Step of luminance (of 255) that begins an image edge."});
  }
};

/// Intensity discontinuities of an rgb image in [0, 255], by Canny's detector: 1 on an edge, else
/// 0. All 0 for an empty image.
Image<std::uint8_t> image_edges(const Image<Eigen::Vector3f>& rgb,
                                const ImageEdgeOptions& options = {});

}  // namespace bpa
