// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/base/stopwatch.hpp"
#include "core/cloud/frame.hpp"
#include "core/observation/scene_features.hpp"
#include "core/pipeline/search_plan.hpp"
#include "core/result/interpretation.hpp"

namespace bpa {

/// What a search reads of the frame, with the time of each step appended to `timings`. The frame
/// must be valid. The pixels of the reduced image follow from frame and plan alone.
SceneFeatures prepare_scene(const Frame& frame, const SearchPlan& plan, const Deadline& deadline,
                            std::vector<StageTiming>& timings);

}  // namespace bpa
