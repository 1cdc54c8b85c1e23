// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/detect/options.hpp"
#include "core/geometry/pose.hpp"
#include "core/model/object_model.hpp"
#include "core/observation/scene_features.hpp"

namespace bpa {

/// One alignment by BPA to sampled super-pixels (V.6). Up to RoundTwoOptions::max_pairs model
/// points that fall within `gate` metres of these are matched as oriented pairs, and half as many
/// edge points as positions. Returns `start` where fewer than RoundTwoOptions::min_pairs match.
Pose align_to_surface(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                      float gate, std::uint64_t seed, const DetectOptions& options = {});

}  // namespace bpa
