// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/geometry/lens.hpp"
#include "core/geometry/symmetry.hpp"

// Data sets in the layout of the BOP benchmark (Hodan et al. 2018, bop_toolkit docs/
// bop_datasets_format.md). Files are in millimetres; everything here is in metres.
//
// A scene may be a sequence of one camera: its images by im_id, a dropped frame left out. Two keys
// that BOP does not have say more: "stamp_ns" in scene_camera.json and "instance_id" in
// scene_gt.json.

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
  int instance = 0;  ///< The same object in all frames of a scene has the same; 0: not known.
};

/// One frame of a split, not loaded yet.
struct BopFrame {
  int scene_id = 0;
  int im_id = 0;
  std::int64_t stamp_ns = 0;  ///< Exposure time, UTC; 0: not known.
  Camera camera;
  std::optional<Pose> camera_from_world;  ///< cam_R_w2c and cam_t_w2c.
  Lens lens;                              ///< Whose distortion is taken out of the images.
  double depth_scale_mm = 1;
  std::string depth_path;
  std::string color_path;  ///< Empty without colour.
  Status unread;           ///< Why it cannot be loaded: of its camera.
  bool has_truth = false;  ///< Whether scene_gt.json is there.
  std::vector<BopInstance> truth;
};

/// The models by obj_id. Fails with not_found (naming the file) or corrupt.
Result<std::vector<BopModel>> read_bop_models(const std::string& dataset);

/// The same of a folder that holds models_info.json and the meshes.
Result<std::vector<BopModel>> read_bop_models_folder(const std::string& folder);

/// The frames of a split by (scene_id, im_id); `scenes` selects scene ids, empty = all. Fails with
/// not_found when the split or a scene asked for is not there, corrupt otherwise. A frame whose
/// camera or images are bad is among them, and fails when it is loaded.
Result<std::vector<BopFrame>> read_bop_frames(const std::string& dataset, const std::string& split,
                                              const std::vector<int>& scenes = {});

/// Loads the images; frame_id is "SCENE/IM", the stamp that of the entry. Fails with `unread`, and
/// as read_frame() does.
Result<Frame> load_bop_frame(const BopFrame& frame, std::string* note = nullptr);

/// "000001" for 1, as scenes and images are named.
std::string bop_number(int number);
/// "obj_000001" for 1.
std::string bop_object_name(int obj_id);

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
  int instance = 0;             ///< As BopInstance::instance; 0 is not written.
};

/// Whether the masks of a scene become files, beside what is counted from them.
enum class BopMasks { written, counted };

/// Writes one scene, frame by frame: SPLIT/SCENE/{rgb,depth,mask,mask_visib}/, and on finish()
/// scene_camera.json, scene_gt.json and scene_gt_info.json.
class BopSceneWriter {
 public:
  /// `depth_scale_mm` is the unit of the depth images; depths above 65535 of it are written as 0.
  BopSceneWriter(const std::string& dataset, const std::string& split, int scene_id,
                 double depth_scale_mm = 1.0, BopMasks masks = BopMasks::written);
  ~BopSceneWriter();
  BopSceneWriter(const BopSceneWriter&) = delete;
  BopSceneWriter& operator=(const BopSceneWriter&) = delete;

  /// The frame's stamp is written unless it is 0. May be called from several threads, in any order.
  /// Fails with invalid_argument when a mask is not of the frame's size, else with unavailable.
  Status add(int im_id, const Frame& frame, const std::vector<BopInstanceRecord>& instances,
             const std::optional<Pose>& camera_from_world = std::nullopt);
  Status finish();

 private:
  struct Records;  // the JSON files so far
  std::string folder_;
  double depth_scale_mm_;
  BopMasks masks_;
  std::unique_ptr<Records> records_;
};

}  // namespace bpa::io
