// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/model/object_model.hpp"
#include "core/score/pose_check.hpp"
#include "core/score/predicted_surface.hpp"

namespace bpa {

/// How much more likely one pose of an object makes the observed depths than another pose of the
/// same object does: the sum of log-likelihood ratios over the pixels on which they disagree, those
/// where one predicts surface and the other, within 6 mm beside, none of that depth. What a pose
/// does not cover may have any depth, and what something hides says next to nothing. Positive for
/// `first`. A handle in sight counts for the pose that has it there, and against the one that hides
/// it.
double rival_evidence(const CheckImage& image, const PredictedSurface& first,
                      const PredictedSurface& second);

/// By how much the evidence for each of some poses (camera_from_object) of a model that claim the
/// same place is behind that for the best of them, from -500 to 0. Each is compared with the first
/// one, which should be a good one.
std::vector<double> behind_best(const CheckImage& image, const ObjectModel& model,
                                std::span<const Pose> poses);

}  // namespace bpa
