// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/base/stopwatch.hpp"
#include "core/pipeline/detector.hpp"

namespace bpa {

/// What a search reads of the frame, with the time of each step appended to `timings`. The frame
/// must be valid; `options` are those of this search (shorten_preparation()). The pixels of the
/// reduced image follow from frame and options alone.
SceneFeatures prepare_scene(const Frame& frame, const DetectRequest& request,
                            DetectorOptions options, const Deadline& deadline,
                            std::vector<StageTiming>& timings);

}  // namespace bpa
