// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <bpa/status.hpp>
#include <bpa/types.hpp>

#include "core/io/bop_dataset.hpp"

namespace bpa::cli {

/// Where frames lie on disk: a BOP data set, or one pair of images.
struct FrameFiles {
  std::string bop;  ///< Folder of a data set; empty: the images below.
  std::string split = "test";
  std::vector<int> scenes;  ///< Empty: all.
  std::string depth;        ///< 16-bit PNG.
  std::string color;        ///< Empty: no colour.
  std::string camera;       ///< A file that io::read_camera reads.

  bool empty() const { return bop.empty() && depth.empty(); }
};

/// Where results go.
struct Sinks {
  std::string json;       ///< File of `bpa detect --json`'s form; empty: none.
  std::string annotated;  ///< Folder of PNGs; empty: none.
  int top = 5;            ///< Interpretations to print a frame; 0 prints nothing.
};

/// What of each frame is searched.
struct Restriction {
  std::vector<int> roi;   ///< x, y, width, height in pixels; empty: the whole image.
  std::string mask_path;  ///< An 8-bit image, black where frames are not searched; empty: none.

  bool empty() const { return roi.empty() && mask_path.empty(); }
  /// Sets the frame's region and mask. Fails with invalid_argument where the mask has another size
  /// than the frame, or as io::read_color_image does.
  Status apply(Frame& frame) const;
};

/// What --priors and its help text need.
void add_priors_option(CLI::App& command, std::string& path);
/// The priors of a file as the SDK takes them; none for an empty path. Fails as
/// io::read_pose_priors does.
Result<std::vector<ExpectedPose>> read_priors(const std::string& path);

void add_restriction_options(CLI::App& command, Restriction& restriction);
void add_frame_options(CLI::App& command, FrameFiles& files);
void add_sink_options(CLI::App& command, Sinks& sinks);

/// `invalid_argument` unless the options name frames in one way; `needed` false allows none.
Status check_frame_options(const FrameFiles& files, bool needed);

/// The frames that the options name, by scene and image number. Fails as io::read_bop_frames and
/// io::read_camera do.
Result<std::vector<io::BopFrame>> list_frames(const FrameFiles& files);
/// Reads a frame with what of it is searched. Fails as io::load_bop_frame and Restriction::apply
/// do.
Result<Frame> load_frame(const io::BopFrame& entry, const Restriction& restriction,
                         std::int64_t stamp_ns);

/// Writes FOLDER/SCENE_IMAGE.png (or the stamp, for frames that are of no data set).
Status write_annotated(const std::string& folder, const AnnotatedImage& image);

}  // namespace bpa::cli
