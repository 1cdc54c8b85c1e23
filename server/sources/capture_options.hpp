// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "camera/camera_options.hpp"
#include "core/base/options.hpp"

namespace bpa::server {

/// A camera of the server's own: the device, and the topics on which its images go out.
struct CaptureOptions : camera::CameraOptions {
  std::string frame_id = "camera_color_optical_frame";
  bool search = true;
  std::string color_topic = "/camera/color/image_raw";
  std::string color_info_topic = "/camera/color/camera_info";
  std::string depth_topic = "/camera/aligned_depth_to_color/image_raw";
  std::string depth_info_topic = "/camera/aligned_depth_to_color/camera_info";
  std::string points_topic = "/camera/depth/color/points";

  template <class Visitor>
  void visit_fields(Visitor&& visit) {
    CameraOptions::visit_fields(visit);
    visit("frame_id", frame_id, FieldRule{0, 0, "Of everything that comes from this camera."});
    visit("search", search, FieldRule{0, 0, "Search its frames; false: only publish them."});
    visit("color_topic", color_topic, FieldRule{0, 0, "sensor_msgs/Image, rgb8; empty: none."});
    visit("color_info_topic", color_info_topic,
          FieldRule{0, 0, "sensor_msgs/CameraInfo beside it; empty: none."});
    visit("depth_topic", depth_topic,
          FieldRule{0, 0, "sensor_msgs/Image, 16UC1 in mm, registered to colour; empty: none."});
    visit("depth_info_topic", depth_info_topic,
          FieldRule{0, 0, "sensor_msgs/CameraInfo beside it; empty: none."});
    visit("points_topic", points_topic,
          FieldRule{0, 0,
                    "sensor_msgs/PointCloud2, xyz and rgb, made only while somebody subscribes; "
                    "empty: none."});
  }
};

}  // namespace bpa::server
