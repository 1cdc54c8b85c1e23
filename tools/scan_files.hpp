// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/modeling/turntable.hpp"
#include "tools/command.hpp"

namespace bpa::cli {

/// Reads a split of a BOP data set as a turntable scan and finds the poses of its views: every
/// scene is a resting position, and the number of an image says how many steps the table has
/// turned. Truth and masks are not read.
AlignedScan align_scan_of(const std::string& dataset, const std::string& split, double step_deg,
                          const CommonOptions& common);

/// The views of a BOP split that show object `obj_id`, with the poses of scene_gt.json; where there
/// is mask_visib, only its pixels belong to the object.
std::vector<PosedView> read_posed_views(const std::string& dataset, const std::string& split,
                                        int obj_id, int num_threads);

}  // namespace bpa::cli
