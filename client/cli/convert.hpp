// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include <bpa/types.hpp>

#include "core/io/results.hpp"
#include "core/result/pose_prior.hpp"

// The SDK's structs <-> core/result, for the files of core/io.

namespace bpa::cli {

/// The scene and image number of a frame_id such as "48/1"; 0, 0 for any other.
std::pair<int, int> scene_and_image(const std::string& frame_id);

/// A server's answer as result files hold it.
io::FrameResult to_frame_result(const DetectionSet& set);

/// The prior with its most probable pose.
ExpectedPose to_expected_pose(const PosePrior& prior);

}  // namespace bpa::cli
