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

/// Map and image of the whole frame: what alignment and checks read. `background` is in the
/// camera's frame. The same for any number of threads (0: one per core).
SceneFeatures observe(const Frame& frame, SensorKind sensor, std::span<const Plane> background,
                      int num_threads);

/// The same of a part of the frame, in whole pixels of the reduced image (surroundings()). One
/// thread.
SceneFeatures observe_part(const Frame& frame, const RegionOfInterest& part, SensorKind sensor,
                           std::span<const Plane> background);

/// The same with colours: what behind_best() reads.
SceneFeatures observe_part_colors(const Frame& frame, const RegionOfInterest& part,
                                  SensorKind sensor, std::span<const Plane> background);

/// Where the frame shows the object and `margin_m` around it, in whole pixels of the reduced image.
/// Nothing where that is outside of the image, nearer than the camera sees or less than 16 pixels
/// of the reduced image wide.
std::optional<RegionOfInterest> surroundings(const Frame& frame, const ObjectModel& model,
                                             const Pose& camera_from_object, double margin_m);

/// Every `step`-th depth of a region in every `step`-th row; an empty region is the whole frame.
std::vector<float> sampled_depths(const Frame& frame, RegionOfInterest region, int step);

/// The share of depths, known in both, that differ by more than noise. 1 where the numbers differ
/// or nothing is known.
double changed_share(const std::vector<float>& now, const std::vector<float>& then,
                     const SensorNoise& noise);

}  // namespace bpa::track
