// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"

namespace bpa::io {

/// Reads one RGB-D frame: a 16-bit depth PNG registered to an 8-bit colour image of the same size.
/// `color_path` may be empty: no colour. A camera without a size takes the depth image's. Checks
/// sizes and camera (messages name the file, the field and the rule), not how much depth there is:
/// that is validate(Frame).
Result<Frame> read_frame(const std::string& depth_path, const std::string& color_path,
                         const Camera& camera, double depth_scale_mm);

}  // namespace bpa::io
