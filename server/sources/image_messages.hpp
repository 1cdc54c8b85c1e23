// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "camera/sensor_images.hpp"
#include "server/convert/frames.hpp"

namespace bpa::server {

/// The images of the server's own camera as messages in the frame `frame_id`: 16UC1 or 32FC1 depth,
/// rgb8 or mono8 colour. At most 5 coefficients of distortion are a plumb_bob, more a
/// rational_polynomial.
CameraImages image_messages(camera::SensorImages images, const std::string& frame_id);

}  // namespace bpa::server
