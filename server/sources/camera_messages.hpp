// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "camera/camera_device.hpp"
#include "core/cloud/frame.hpp"
#include "server/convert/frames.hpp"

namespace bpa::server {

/// The images of the server's own camera as messages in the frame `frame_id`: 16UC1 or 32FC1 depth,
/// rgb8 or mono8 colour. Up to 5 coefficients of distortion: plumb_bob; more: rational_polynomial.
CameraImages image_messages(camera::SensorImages images, const std::string& frame_id);

/// A frame as an organised cloud: x y z in metres and rgb, 16 bytes a point; NaN where there is no
/// depth. Colour is black in a frame without.
wire::sensor_msgs::PointCloud2 cloud_message(const Frame& frame);

}  // namespace bpa::server
