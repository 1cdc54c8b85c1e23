// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/model/object_model.hpp"
#include "core/observation/scene_features.hpp"
#include "core/score/pose_check.hpp"
#include "core/score/predicted_surface.hpp"

namespace bpa::score {

using Pixels = std::vector<Eigen::Vector2i>;

/// Where two poses of one object disagree: one predicts surface and the other, within 6 mm beside,
/// none of that depth.
Pixels disagreement(const CheckImage& image, const PredictedSurface& first,
                    const PredictedSurface& second);

/// Log-likelihood ratio of the observed depths at these pixels; positive favours `first`. A pixel
/// that a pose does not cover may have any depth. Occluded pixels count for almost nothing.
double depth_evidence(const CheckImage& image, const PredictedSurface& first,
                      const PredictedSurface& second, const Pixels& pixels);

/// Log-likelihoods of one of several poses.
struct RivalEvidence {
  double depth = 0;
  double color = 0;  ///< 0 without colours.
};

/// Log-likelihoods of each pose (camera_from_object) minus those of the best of the first
/// `contenders` poses, clamped to [-500, 0]. All poses are of one model, in one place. Each is
/// compared with the first, which should fit well. Colours: the pattern of the surface, and whether
/// the pixels where poses disagree show the object or what is around it.
std::vector<RivalEvidence> behind_best(const SceneFeatures& scene, const ObjectModel& model,
                                       std::span<const Pose> poses, std::size_t contenders);

}  // namespace bpa::score
