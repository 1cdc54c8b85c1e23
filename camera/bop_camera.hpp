// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "camera/camera_device.hpp"
#include "camera/camera_options.hpp"

namespace bpa::camera {

/// The frames of a data set in the BOP layout (its split "test"; FOLDER:SPLIT names another), in
/// order, 30 a second times capture.speed.
Result<std::unique_ptr<CameraDevice>> open_bop_camera(const std::string& folder,
                                                      const CameraOptions& options);

}  // namespace bpa::camera
