// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "core/pipeline/detector.hpp"
#include "server/object_tracker.hpp"

namespace bpa::server {

/// A tracker of the models of a detector, which `current` gives and may replace at any time.
std::unique_ptr<ObjectTracker> make_library_tracker(
    std::function<std::shared_ptr<const Detector>()> current, score::ScoreLayers layers,
    const track::TrackerOptions& options);

}  // namespace bpa::server
