// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/io/results.hpp"
#include "core/model/library.hpp"
#include "core/result/interpretation.hpp"

namespace bpa::cli {

/// Loads a library for detection, with a progress bar; `names` selects models, empty = all.
Result<std::shared_ptr<const ModelLibrary>> load_detection_library(
    const std::string& folder, const std::vector<std::string>& names, int num_threads);

/// What files hold of a detection. Poses, covariances and orientations are turned into another
/// frame when the detection's camera is not the one to report in.
io::FrameResult to_frame_result(const SceneInterpretations& scene, int scene_id, int im_id,
                                double seconds, const Pose& reported_from_camera = {});

}  // namespace bpa::cli
