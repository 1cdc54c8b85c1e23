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

/// Where frames lie on disk: a BOP data set, or one pair of images. And what of each is searched.
struct FrameFiles {
  std::string bop;  ///< Folder of a data set; empty: the images below.
  std::string split = "test";
  std::vector<int> scenes;  ///< Empty: all.
  std::string depth;        ///< 16-bit PNG.
  std::string color;        ///< Empty: no colour.
  std::string camera;       ///< A file that io::read_camera reads.
  std::vector<int> roi;     ///< x, y, width, height in pixels; empty: the whole image.
  std::string mask;         ///< An 8-bit image, black where frames are not searched; empty: none.

  bool empty() const { return bop.empty() && depth.empty(); }
};

/// What --priors and its help text need.
void add_priors_option(CLI::App& command, std::string& path);
/// The priors of a file as the SDK takes them; none for an empty path.
std::vector<ExpectedPose> read_priors(const std::string& path);

void add_frame_options(CLI::App& command, FrameFiles& files);

/// Throws a CLI::ValidationError of the command unless the options name frames in one way; `needed`
/// false allows none.
void check_frame_options(const char* command, const FrameFiles& files, bool needed);

/// The frames that the options name, by scene and image number.
std::vector<io::BopFrame> list_frames(const FrameFiles& files);
/// Reads one of them with what of it is searched; the mask must have its size.
Frame load_frame(const io::BopFrame& entry, const FrameFiles& files, std::int64_t stamp_ns);

/// Writes FOLDER/SCENE_IMAGE.png (or the stamp, for frames that are of no data set).
Status write_annotated(const std::string& folder, const AnnotatedImage& image);

}  // namespace bpa::cli
