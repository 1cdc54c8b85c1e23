// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/cloud/frame.hpp"
#include "core/cloud/image.hpp"

namespace bpa {

/// Where and in which direction colours change, at the full resolution of the frame: of the three
/// channels of CIELAB, blurred by one pixel, the gradient of the one that changes most
/// (Hinterstoisser et al., "Multimodal templates", ICCV 2011). Its length m, CIELAB a pixel,
/// becomes m / (m + 2) in [0, 1): beyond noise, contrast counts for little. Empty without colour.
/// The same for any number of threads.
Image<Eigen::Vector2f> color_gradients(const Frame& frame, int num_threads);

}  // namespace bpa
