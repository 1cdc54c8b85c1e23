// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/camera_device.hpp"
#include "camera/camera_options.hpp"
#include "core/base/log.hpp"
#include "core/base/status.hpp"

namespace bpa::camera {

/// What opens the camera that `options.source` names; `invalid_argument` when it names none.
Result<OpenCamera> camera_of(const CameraOptions& options, const LogHook& log);

/// Whether capture.every_frame applies: recordings and data sets wait, sensors do not.
bool is_paced(const CameraOptions& options);

}  // namespace bpa::camera
