// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/search.hpp"

namespace bpa::cli {

/// How soon a detector with these options finds what is in the frames: they are searched in 1, 2,
/// 4, 8 and 16 rounds that explain nothing away. `start`: what is too rare to be measured.
score::SearchYield search_yield(const std::shared_ptr<const ModelLibrary>& library,
                                DetectorOptions options, const score::ScoreLayers& layers,
                                const std::vector<DatasetOptions>& datasets,
                                const CommonOptions& common, int models_per_frame,
                                const score::SearchYield& start);

}  // namespace bpa::cli
