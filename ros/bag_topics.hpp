// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/options.hpp"

namespace bpa::ros {

/// The topics of a recording that make frames; an empty name: found by type.
struct BagTopics {
  BPA_NAMED_OPTION("bag_depth", std::string, depth, "", (),
                   "Topic of depth images of a recording of ROS 2; empty: found by their type.");
  BPA_NAMED_OPTION(
      "bag_color", std::string, color, "", (),
      "Topic of its colour images, registered to depth; empty: those of the depth's frame.");
  BPA_NAMED_OPTION("bag_camera_info", std::string, camera_info, "", (),
                   "Topic of its camera info; empty: the one beside the images.");
  BPA_NAMED_OPTION("bag_cloud", std::string, cloud, "", (),
                   "Topic of its organised clouds; empty: where there are no depth images.");
};

}  // namespace bpa::ros
