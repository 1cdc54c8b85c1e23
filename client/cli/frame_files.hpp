// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <bpa/status.hpp>
#include <bpa/types.hpp>

namespace bpa::cli {

/// Where frames lie on disk: a BOP data set, or one pair of PNGs.
struct FrameFiles {
  std::string bop;  ///< Folder of a data set; empty: the PNGs below.
  std::string split = "test";
  std::vector<int> scenes;  ///< Empty: all.
  std::string depth;        ///< 16-bit PNG.
  std::string color;        ///< PNG; empty: no colour.
  std::string camera;       ///< BOP camera.json (fx fy cx cy, depth_scale; or cam_K).
};

/// A frame that has not been read yet.
struct FrameEntry {
  int scene_id = 0;
  int im_id = 0;
  std::string depth_path;
  std::string color_path;  ///< Empty without colour.
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double depth_scale_mm = 1;  ///< Millimetres of one unit of the depth image.

  std::string name() const;  ///< "SCENE/IM", also the frame_id.
};

/// A frame that owns its pixels.
struct LoadedFrame {
  FrameView view;  ///< Points into the vectors below.
  std::vector<std::uint8_t> rgb;
  std::vector<float> depth_m;

  LoadedFrame() = default;
  LoadedFrame(LoadedFrame&&) = default;  // vectors keep their memory when moved
  LoadedFrame& operator=(LoadedFrame&&) = default;
};

/// The frames by scene and image number. Fails with not_found or corrupt, naming the file.
Result<std::vector<FrameEntry>> list_frames(const FrameFiles& files);

/// Reads the images. Depth in metres comes out as `bpa detect` reads it, to the last bit.
Result<LoadedFrame> load_frame(const FrameEntry& entry, std::int64_t stamp_ns);

}  // namespace bpa::cli
