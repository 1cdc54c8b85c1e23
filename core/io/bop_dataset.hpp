// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "core/geometry/symmetry.hpp"

// Data sets in the layout of the BOP benchmark (Hodan et al. 2018, bop_toolkit docs/
// bop_datasets_format.md). Files are in millimetres; everything here is in metres.

namespace bpa::io {

/// One entry of models/models_info.json.
struct BopModel {
  int obj_id = 0;
  std::string name;  ///< "name" of models_info.json, else obj_NNNNNN.
  std::string path;  ///< Of the PLY file.
  double diameter = 0;
  SymmetryGroup symmetry;
};

/// One object that is truly in a frame.
struct BopInstance {
  int obj_id = 0;
  Pose camera_from_object;
  double visible_fraction = 1;  ///< visib_fract of scene_gt_info.json; 1 without that file.
};

/// One frame of a split, not loaded yet.
struct BopFrame {
  int scene_id = 0;
  int im_id = 0;
  Camera camera;
  double depth_scale_mm = 1;
  std::string depth_path;
  std::string color_path;  ///< Empty without colour.
  bool has_truth = false;  ///< Whether scene_gt.json is there.
  std::vector<BopInstance> truth;
};

/// The models by obj_id. Fails with not_found (naming the file) or corrupt.
Result<std::vector<BopModel>> read_bop_models(const std::string& dataset);

/// The frames of a split by (scene_id, im_id); `scenes` selects scene ids, empty = all. Fails with
/// not_found when the split or a scene asked for is not there, corrupt otherwise.
Result<std::vector<BopFrame>> read_bop_frames(const std::string& dataset, const std::string& split,
                                              const std::vector<int>& scenes = {});

/// Loads the images; frame_id is "SCENE/IM", the stamp 0.
Result<Frame> load_bop_frame(const BopFrame& frame);

/// "000001" for 1, as scenes and images are named.
std::string bop_number(int number);
/// "obj_000001" for 1.
std::string bop_object_name(int obj_id);

}  // namespace bpa::io
