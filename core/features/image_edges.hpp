// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/base/options.hpp"
#include "core/cloud/image.hpp"

namespace bpa {

struct ImageEdgeOptions {
  double blur_px = 0.8;  ///< Standard deviation of the blur before gradients are taken.
  double low = 10;       ///< Steps of luminance (of 255) that go on an edge,
  double high = 25;      ///< and that begin one.
  int num_threads = 0;

  template <class Visitor>
  void visit_fields(Visitor&& visit) {
    visit("blur_px", blur_px, FieldRule{0, 10, "Blur before intensity gradients, pixels."});
    visit("low", low, FieldRule{0, 255, "Step of luminance that continues an image edge."});
    visit("high", high, FieldRule{0, 255, "Step of luminance that begins an image edge."});
  }
};

/// Intensity discontinuities of an rgb image in [0, 255], by Canny's detector: 1 on an edge, else
/// 0. All 0 for an empty image.
Image<std::uint8_t> image_edges(const Image<Eigen::Vector3f>& rgb,
                                const ImageEdgeOptions& options = {});

}  // namespace bpa
