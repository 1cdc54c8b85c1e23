// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "camera/camera_device.hpp"
#include "camera/camera_options.hpp"
#include "core/base/log.hpp"

namespace bpa::camera {

/// Which device of OpenNI2.
struct Openni2Target {
  std::string uri;    ///< Empty: the first that is found; a path for a recording.
  bool file = false;  ///< A recording (.oni), which is checked before OpenNI2 sees it.
};

/// Opens and starts a device of OpenNI2: modes, no mirroring, depth and colour in step, depth
/// registered to colour. OpenNI2 is loaded first if it is not. `unavailable` when the device is not
/// there, `invalid_argument` when a setting does not fit it, `corrupt` for a damaged recording.
OpenCamera openni2_camera(const Openni2Target& target, const CameraOptions& options, LogHook log);

/// The OpenNI2 devices with their modes and what is wrong with each, and the depth sensors on USB
/// that OpenNI2 does not serve, as text for people. Opens each device for a moment. Fails when
/// OpenNI2 has no drivers.
Result<std::string> list_devices();

}  // namespace bpa::camera
