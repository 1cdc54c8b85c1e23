// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/geometry/lens.hpp"

namespace bpa {

/// For every pixel of the undistorted image, the index of the nearest pixel of the distorted one;
/// -1 outside. The camera matrix stays the same.
std::vector<std::int32_t> undistortion_map(const Camera& camera, const Lens& lens);

/// Takes the distortion out of depth and colour (nearest pixel); pixels outside are 0.
void undistort(const Lens& lens, Frame& frame);

}  // namespace bpa
