// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bpa/types.hpp>

#include "core/cloud/frame.hpp"

namespace bpa::cli {

/// A core frame as the SDK takes it. Points into `frame`, which must outlive the view.
inline FrameView view_of(const Frame& frame) {
  FrameView view;
  view.width = frame.camera.width;
  view.height = frame.camera.height;
  view.rgb = frame.color.empty() ? nullptr : frame.color.data();
  view.depth_m = frame.depth.data();
  view.fx = frame.camera.fx;
  view.fy = frame.camera.fy;
  view.cx = frame.camera.cx;
  view.cy = frame.camera.cy;
  view.stamp_ns = frame.stamp_ns;
  view.frame_id = frame.frame_id;
  view.mask = frame.mask.empty() ? nullptr : frame.mask.data();
  view.roi = {{frame.roi.x, frame.roi.y, frame.roi.width, frame.roi.height}};
  return view;
}

}  // namespace bpa::cli
