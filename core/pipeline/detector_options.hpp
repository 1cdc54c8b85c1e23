// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/options.hpp"
#include "core/cloud/planes.hpp"
#include "core/cloud/surface_map.hpp"
#include "core/detect/options.hpp"
#include "core/observation/scene_features.hpp"
#include "core/pipeline/views_options.hpp"
#include "core/scene/interpretations.hpp"

namespace bpa {

/// How often the search looks at the scene.
struct RoundOptions {
  BPA_OPTION(double, max_missed, 0.15, (0, 1000),
             "The search ends when it expects to have missed fewer objects in sight than this. 0: "
             "it goes on until all surface is searched.");
  BPA_OPTION(int, max_rounds, 20, (1, 1000),
             "Rounds of the search at most, each with another sample of the scene.");
  BPA_OPTION(double, min_certain, 0.85, (0, 1),
             "Surface that a placement of at least this probability explains is not searched in "
             "later rounds.");
};

/// Every setting of the detector, a group for each stage. The defaults are meant for a Kinect-class
/// sensor and household objects; config/detector.yaml lists them all.
struct DetectorOptions {
  BPA_GROUP(SurfaceMapOptions, surface, "The surface in the depth image.");
  BPA_GROUP(PlaneOptions, planes, "Background planes.");
  BPA_GROUP(SceneFeatureOptions, features, "What is computed once for all models.");
  BPA_GROUP(RoundOptions, rounds, "Rounds of the search.");
  BPA_INLINE_GROUP(detect::DetectOptions, detect);
  BPA_GROUP(scene::InterpretationOptions, scene,
            "Interpretations of the whole scene (paper section VI).");
  BPA_GROUP(ViewsOptions, views, "Several views of one scene.");
};

/// Reads a YAML file that overrides some defaults: groups of fields, or fields by their own name
/// where it is unique. Fails with not_found or invalid_argument. The message names the file, the
/// line, the key (unknown keys are errors), the value and the rule.
Result<DetectorOptions> load_detector_options(const std::string& path);

}  // namespace bpa
