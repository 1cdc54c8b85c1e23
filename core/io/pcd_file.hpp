// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/geometry/pose.hpp"

namespace bpa::io {

/// A PCD file as it is: height 1 when not organised, NaN where an organised cloud has no point.
struct PcdCloud : PointCloud {
  int width = 0;
  int height = 0;

  bool organised() const { return height > 1; }
};

/// Reads ascii, binary and compressed PCD files with fields x y z. Optional fields: rgb or rgba,
/// normal_x normal_y normal_z. Fails with not_found, corrupt or invalid_argument (no x y z). Memory
/// is taken for 50 million points at most, and for no more than the bytes of the file can hold.
Result<PcdCloud> read_pcd(const std::string& path);
/// The same of the bytes of a file; `name` is for messages.
Result<PcdCloud> parse_pcd(std::string_view bytes, const std::string& name);

/// The finite points, scaled.
PointCloud drop_invalid_points(const PointCloud& cloud, double scale = 1.0);

/// An organised cloud as a frame.
struct OrganisedFrame {
  Frame frame;
  /// Where the camera's optical frame is in the cloud's own frame: identity, or a half turn about x
  /// for a cloud with y up and z toward the viewer. pose_in_cloud = cloud_from_camera * pose.
  Pose cloud_from_camera;
  /// What was found out, a sentence each, for people: the camera, the unit where it is not metres,
  /// and that the cloud was turned.
  std::vector<std::string> notes;
};

/// Makes a frame of an organised cloud. The camera is `camera` if given. Else it is the best
/// pinhole: least squares in u z = fx x + cx z, v z = fy y + cy z. `unit` is metres of one unit of
/// the cloud; 0: metres, or millimetres where the median depth is over 100. Fails with
/// invalid_argument when the cloud is not organised or has under 500 finite points. Also when it is
/// not in its camera's frame: points on both sides, or no pinhole that fits (mean residual over 2
/// pixels).
Result<OrganisedFrame> frame_from_organised_cloud(const PcdCloud& cloud,
                                                  const Camera* camera = nullptr, double unit = 0);

}  // namespace bpa::io
