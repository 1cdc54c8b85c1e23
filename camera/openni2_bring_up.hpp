// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "camera/camera_options.hpp"
#include "camera/openni2_connection.hpp"
#include "camera/openni2_streams.hpp"
#include "camera/registration.hpp"
#include "core/base/log.hpp"

namespace bpa::camera {

/// Who registers depth to colour.
enum class Registrar { none, device, server };

/// What must be known of a device to make images of its frames.
struct Openni2Setup {
  StreamFormat depth;
  StreamFormat color;       ///< Of no meaning without colour.
  DeviceGeometry geometry;  ///< Of the two cameras, without registration.
  Intrinsics output;        ///< Of the images that go out.
  Registrar registrar = Registrar::none;
  std::string complaint;  ///< Why there is no colour although it was asked for; empty: nothing.
};

/// Makes and starts the streams of a device: modes, no mirroring, exposure, the cameras' geometry,
/// registration of depth to colour, and last depth and colour in step. `unavailable` when the
/// device fails, `invalid_argument` when a setting does not fit it, `unsupported` when it cannot do
/// what is asked. Only files named openni2* include this.
Result<Openni2Setup> bring_up(Openni2Connection& connection, const CameraOptions& options,
                              const LogHook& log);

}  // namespace bpa::camera
