// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "idl/wire/msg/sensor_msgs.hpp"

// Messages of the server's own camera.

namespace bpa::server {

wire::std_msgs::Header header_now(const std::string& frame_id);

/// An image without padding whose pixels are zero.
wire::sensor_msgs::Image empty_image(const wire::std_msgs::Header& header, int width, int height,
                                     const char* encoding, std::size_t pixel_bytes);

/// `distortion` holds k1 k2 p1 p2 k3 ...: at most 5 are a plumb_bob, more a rational_polynomial.
wire::sensor_msgs::CameraInfo camera_info(const wire::std_msgs::Header& header,
                                          const Camera& camera,
                                          const std::vector<double>& distortion);

}  // namespace bpa::server
