// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/capture/camera_device.hpp"
#include "server/capture/capture_options.hpp"

namespace bpa::server {

/// The frames of a data set in the BOP layout (its split "test"; FOLDER:SPLIT names another), in
/// order, 30 a second times capture.speed.
Result<std::unique_ptr<CameraDevice>> open_bop_source(const std::string& folder,
                                                      const CaptureOptions& options);

}  // namespace bpa::server
