// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include <bpa/types.hpp>

#include "core/cloud/frame.hpp"
#include "core/io/results.hpp"
#include "core/io/tracks.hpp"
#include "core/result/pose_prior.hpp"

// The SDK's structs <-> frames and results of the core.

namespace bpa::cli {

/// The scene and image number of a frame_id such as "48/1"; 0, 0 for any other.
std::pair<int, int> scene_and_image(const std::string& frame_id);

/// A server's answer as result files hold it.
io::FrameResult to_frame_result(const DetectionSet& set);

/// Tracks as files hold them.
io::TrackResult to_track_result(const TrackSet& set);

/// The prior with its most probable pose.
ExpectedPose to_expected_pose(const PosePrior& prior);

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
