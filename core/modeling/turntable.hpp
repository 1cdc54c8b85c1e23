// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/cloud/planes.hpp"
#include "core/modeling/posed_view.hpp"

// From the images of an object on a turntable to views with poses (paper section III). Each resting
// position is a set of views from a fixed camera; all that is known is the step of the table.

namespace bpa::modeling {

/// One image of a scan; the pose of its view is not known yet.
struct ScanView {
  PosedView view;
  int step = 0;  ///< How many steps the table has turned since the first image.
};

struct ScanOptions {
  double step_deg = 10;       ///< Either way round; may be wrong by a few per cent.
  double max_height_m = 0.6;  ///< Of the object.
  std::uint64_t seed = 0;
  int num_threads = 0;
};

/// What was found of one resting position. Camera frame.
struct RestingPosition {
  Plane plane;                                       ///< Of the table's top.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< Where the axis meets the plane, metres.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   ///< Of rotation, up.
  double step_deg = 0;  ///< Signed: positive counter-clockwise seen from above.
  /// Views that show the object, with camera_from_object set: the object's frame has its origin
  /// where the axis meets the table, z up.
  std::vector<PosedView> views;
  std::vector<int> steps;     ///< ScanView::step of each of the views.
  double sense_evidence = 0;  ///< How much better counter-clockwise fits the scans than clockwise:
                              ///< difference of mean squared distances, metres squared.
  int missed = 0;             ///< Views that do not show the object and were left out.
};

/// Marks the object's pixels in the views: what stands on the turntable. Returns the table's plane.
/// Fails with not_found when there is no plane or nothing on it.
Result<Plane> segment_object(std::vector<ScanView>& views, const ScanOptions& options);

/// Finds plane, object and centre of rotation of one resting position. Fails with not_found when
/// there is no turntable, nothing on it, or fewer than 3 views that show the object.
Result<RestingPosition> align_resting_position(std::vector<ScanView> views,
                                               const ScanOptions& options);

/// Finds step, centre, axis and the poses of the views, from the plane and the views. `sense`: 1
/// when the table turns counter-clockwise, -1 clockwise, 0 to find out. 0 fails for an object in
/// the middle that looks the same from all sides.
void find_axis(RestingPosition& position, int sense, const ScanOptions& options);

/// Registers every resting position to the first and applies the rigid motion to its views' poses.
/// Of several motions that fit, one that puts another side down is likelier. Returns a line for
/// each poor fit, whose views are left out.
std::vector<std::string> merge_resting_positions(std::vector<RestingPosition>& positions,
                                                 const ScanOptions& options);

/// Shifts a pose that lays the surface of one resting position onto that of another. The face that
/// the object stands on in either one, if the other shows it, then lies on its table: z = 0 in both
/// frames. Leaves the pose as it is where that makes the overlap worse.
Pose settle_on_tables(const PointCloud& source, const PointCloud& target,
                      const Pose& target_from_source);

/// All of it: the views of all resting positions in one object frame (that of the first). The table
/// turns the same way in all of them. Warnings say what was left out.
struct AlignedScan {
  std::vector<PosedView> views;
  std::vector<RestingPosition> positions;  ///< Without their views.
  std::vector<std::string> warnings;
};
Result<AlignedScan> align_scan(std::vector<std::vector<ScanView>> positions,
                               const ScanOptions& options);

}  // namespace bpa::modeling
