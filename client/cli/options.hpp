// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <bpa/status.hpp>
#include <bpa/types.hpp>

#include "client/cli/frame_files.hpp"

namespace bpa::cli {

/// Where results go.
struct Sinks {
  std::string json;       ///< File of `bpa detect --json`'s form; empty: none.
  std::string annotated;  ///< Folder of PNGs; empty: none.
  int top = 5;            ///< Interpretations to print a frame; 0 prints nothing.
};

/// What of each frame is searched.
struct Restriction {
  std::vector<int> roi;            ///< x, y, width, height; empty: the whole image.
  std::string mask_path;           ///< An 8-bit PNG; empty: none.
  std::vector<std::uint8_t> mask;  ///< Its pixels once load() has read them, 0 where it is black.
  int mask_width = 0;
  int mask_height = 0;

  bool empty() const { return roi.empty() && mask_path.empty(); }
  Status load();
  /// Fails with invalid_argument where the mask has another size than the frame, which will point
  /// to it.
  Status apply(FrameView& frame) const;
};

void add_restriction_options(CLI::App& command, Restriction& restriction);
void add_frame_options(CLI::App& command, FrameFiles& files);
void add_sink_options(CLI::App& command, Sinks& sinks);

/// `invalid_argument` unless the options name frames in one way; `needed` false allows none.
Status check_frame_options(const FrameFiles& files, bool needed);

/// Writes FOLDER/SCENE_IMAGE.png (or the stamp, for frames that are of no data set).
Status write_annotated(const std::string& folder, const AnnotatedImage& image);

}  // namespace bpa::cli
