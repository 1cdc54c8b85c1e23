// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/cloud/planes.hpp"
#include "core/cloud/sensor_kind.hpp"
#include "core/model/object_model.hpp"
#include "core/observation/scene_features.hpp"

namespace bpa::track {

/// The part of a frame around an object, in whole pixels of the reduced image.
struct Surroundings {
  RegionOfInterest region;
  int reduction = 1;  ///< Frame pixels per map pixel, as of the whole frame's SurfaceMap.
};

/// Where the frame shows the object and `margin_m` around it. Nothing where that is outside of the
/// image, nearer than the camera sees or less than 16 pixels of the reduced image wide.
std::optional<Surroundings> surroundings(const Frame& frame, const ObjectModel& model,
                                         const Pose& camera_from_object, double margin_m);

/// Every `step`-th depth of a region in every `step`-th row; an empty region is the whole frame.
std::vector<float> sampled_depths(const Frame& frame, RegionOfInterest region, int step);

/// The share of depths, known in both, that differ by more than noise. 1 where the numbers differ
/// or nothing is known.
double changed_share(const std::vector<float>& now, const std::vector<float>& then,
                     const SensorNoise& noise);

/// Map and image of the surroundings alone: what alignment and checks read. With `colors` also what
/// behind_best() reads. `background` is in the camera's frame. One thread.
SceneFeatures observe(const Frame& frame, const Surroundings& around, SensorKind sensor,
                      std::span<const Plane> background, bool colors);

}  // namespace bpa::track
