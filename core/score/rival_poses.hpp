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

/// Log-likelihood ratio of the observed depths under two poses of one object; positive favours
/// `first`. Sums over the pixels where the poses disagree: one predicts surface and the other,
/// within 6 mm beside, none of that depth. A pixel that a pose does not cover may have any depth.
/// Occluded pixels count for almost nothing. A visible handle favours the pose that predicts it
/// there.
double rival_evidence(const CheckImage& image, const PredictedSurface& first,
                      const PredictedSurface& second);

/// Log-likelihood of each pose (camera_from_object) minus that of the best, clamped to [-500, 0].
/// All poses are of one model, in one place. Each is compared with the first, which should fit
/// well. The pattern of the surface counts where `log_light` is not empty.
std::vector<double> behind_best(const CheckImage& image, const Image<Eigen::Vector3f>& log_light,
                                const ObjectModel& model, std::span<const Pose> poses);

}  // namespace bpa
