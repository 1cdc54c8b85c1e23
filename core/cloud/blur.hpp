// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/cloud/image.hpp"

namespace bpa {

// OpenCV's GaussianBlur rounds by the processor's instruction set. These sums run in a fixed order:
// the same bits on every machine, for any number of threads.

/// The image blurred by a Gaussian of `sigma` pixels, cut off at three of them; beyond the border
/// the image goes on as its last pixel. The image itself when sigma is not positive. The same for
/// any number of threads.
Image<float> blur(const Image<float>& image, double sigma, int num_threads);
/// Channel by channel.
Image<Eigen::Vector3f> blur(const Image<Eigen::Vector3f>& image, double sigma, int num_threads);

/// The largest value that blur() leaves of a straight line one pixel wide of value 1.
float blurred_line_peak(double sigma);

}  // namespace bpa
