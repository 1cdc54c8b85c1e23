// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/io/bop_dataset.hpp"
#include "tools/search.hpp"

// The arguments of bpa detect and the frames that they name.

namespace bpa::cli {

struct DetectArguments {
  CommonOptions common;
  DetectorArguments detector;
  std::vector<std::string> pcd, depth, color;
  std::string camera;
  DatasetOptions dataset;
  std::string priors, mask;
  std::vector<int> roi;
  int fuse = 1;
  int top = 20;
  double budget_ms = 0;
  std::string csv, json, annotate, explain;
};

/// A frame, and the frame of reference that its poses are reported in.
struct Input {
  std::string name;  ///< For people.
  Frame frame;       ///< Its depth is clean.
  Pose reported_from_camera;
};

/// The frames that the arguments name, by scene and image number. Frames of no data set are the
/// images of scene 0; the path of a PCD cloud is in depth_path.
std::vector<io::BopFrame> list_inputs(const DetectArguments& arguments);

/// Reads one of list_inputs().
Input read_input(const DetectArguments& arguments, const io::BopFrame& entry);

}  // namespace bpa::cli
