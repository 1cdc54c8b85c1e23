// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/detect/pose_prior.hpp"
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
  int scene_id = 0;
  int im_id = 0;
  bool has_truth = false;
  std::vector<io::BopInstance> truth;
};

/// The name of files about a frame.
std::string file_name(const Input& input);

/// The frames that the arguments name, one after another.
class Inputs {
 public:
  /// Lists the frames; `arguments` must outlive it.
  static Result<Inputs> open(const DetectArguments& arguments);

  std::size_t size() const;
  Result<Input> read(std::size_t index) const;
  /// No frame of the same scene follows.
  bool ends_scene(std::size_t index) const;

 private:
  explicit Inputs(const DetectArguments& arguments) : a_(&arguments) {}
  Result<Input> read_pcd(std::size_t index) const;
  Result<Input> read_png(std::size_t index) const;

  const DetectArguments* a_;
  std::vector<io::BopFrame> bop_;
};

/// What the caller says of every frame.
struct Given {
  RegionOfInterest roi;
  std::vector<std::uint8_t> mask;
  std::vector<PosePrior> priors;  ///< In the frame that poses are reported in.
};
Result<Given> read_given(const DetectArguments& arguments);

}  // namespace bpa::cli
