// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <bpa/types.hpp>

#include "tests/support/wall_messages.hpp"

namespace bpa::support {

/// The slanted wall of wall_messages.hpp as users of the SDK send it.
struct WallView {
  std::vector<std::uint16_t> depth = wall_depth_mm();
  std::vector<std::uint8_t> rgb = wall_rgb();

  /// Points into this.
  FrameView view(std::int64_t stamp_ns = 1'000) const {
    FrameView view;
    view.width = static_cast<int>(kWidth);
    view.height = static_cast<int>(kHeight);
    view.rgb = rgb.data();
    view.depth_mm = depth.data();
    view.fx = view.fy = 60;
    view.cx = 31.5;
    view.cy = 23.5;
    view.stamp_ns = stamp_ns;
    view.frame_id = "wall";
    return view;
  }
};

}  // namespace bpa::support
