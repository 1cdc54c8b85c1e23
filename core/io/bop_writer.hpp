// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/cloud/point_cloud.hpp"
#include "core/io/bop_dataset.hpp"

namespace bpa::io {

/// A mesh to write as models/obj_NNNNNN.ply, with what models_info.json says of it.
struct BopMesh {
  int obj_id = 0;
  std::string name;
  double diameter = 0;
  SymmetryGroup symmetry;
  TriangleMesh mesh;  ///< Metres.
};

/// Writes DATASET/models: every mesh and models_info.json.
Status write_bop_models(const std::string& dataset, const std::vector<BopMesh>& meshes);

/// One object in a frame to be written.
struct BopInstanceRecord {
  int obj_id = 0;
  Pose camera_from_object;
  /// Row-major, 1 = the object is what is seen there. Written as mask_visib; the pixel counts and
  /// boxes of scene_gt_info.json come from it. Empty: no mask, nothing visible.
  std::vector<std::uint8_t> mask_visible;
  /// The same as if the object were alone: the silhouette. Empty: not written; then the visible
  /// fraction cannot be known and `visible_fraction` is written.
  std::vector<std::uint8_t> mask;
  double visible_fraction = 1;  ///< Used when `mask` is empty.
};

/// Writes one scene, frame by frame: SPLIT/SCENE/{rgb,depth,mask,mask_visib}/, and on finish()
/// scene_camera.json, scene_gt.json and scene_gt_info.json.
class BopSceneWriter {
 public:
  /// `depth_scale_mm` is the unit of the depth images; depths above 65535 of it are written as 0.
  BopSceneWriter(const std::string& dataset, const std::string& split, int scene_id,
                 double depth_scale_mm = 1.0);
  ~BopSceneWriter();
  BopSceneWriter(const BopSceneWriter&) = delete;
  BopSceneWriter& operator=(const BopSceneWriter&) = delete;

  /// Fails with invalid_argument when a mask has another size than the frame, unavailable when a
  /// file cannot be written.
  Status add(int im_id, const Frame& frame, const std::vector<BopInstanceRecord>& instances);
  Status finish();

 private:
  struct Records;  // the JSON files so far
  std::string folder_;
  double depth_scale_mm_;
  std::unique_ptr<Records> records_;
};

}  // namespace bpa::io
