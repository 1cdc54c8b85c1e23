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
  BPA_OPTION(int, max_rounds, 12, (1, 100),
             "Rounds of the search, each with another sample of the scene.");
  BPA_OPTION(double, min_certain, 0.85, (0, 1),
             "Surface that a placement of at least this probability explains is not searched in "
             "later rounds.");
  BPA_OPTION(double, min_gain, 0.04, (0, 1),
             "The search ends after a round, but not the first, that makes the surface of no "
             "placement more probable by this, in the mean of its pixels.");
  BPA_OPTION(double, min_gain_of_two, 0.15, (0, 1),
             "It ends, too, after two rounds in a row neither of which gains this. With both 0, it "
             "ends after max_rounds.");
  BPA_OPTION(double, expected_share, 0.6, (0.01, 1),
             "Of a round's sample, what the first round takes where an earlier frame says what to "
             "expect. The search may end after it.");
  BPA_OPTION(double, min_gain_expected, 0.3, (0, 1),
             "min_gain where an earlier frame says what to expect.");
  BPA_OPTION(int, step_without_support, 0, (0, 1000),
             "From the second round on, models without support search one in so many points of the "
             "sample. 0: one in (models / 60).");
};

/// Every setting of the detector, a group for each stage. The defaults are meant for a Kinect-class
/// sensor and household objects; config/detector.yaml lists them all.
struct DetectorOptions {
  BPA_GROUP(SurfaceMapOptions, surface, "The surface in the depth image.");
  BPA_GROUP(PlaneOptions, planes, "Background planes.");
  BPA_GROUP(SceneFeatureOptions, features, "What is computed once for all models.");
  BPA_GROUP(RoundOptions, rounds, "Rounds of the search.");
  BPA_INLINE_GROUP(DetectOptions, detect);
  BPA_GROUP(InterpretationOptions, scene, "Interpretations of the whole scene (paper section VI).");
  BPA_GROUP(ViewsOptions, views, "Several views of one scene.");
};

/// Reads a YAML file that overrides some defaults: groups of fields, or fields by their own name
/// where it is unique. Fails with not_found or invalid_argument. The message names the file, the
/// line, the key (unknown keys are errors), the value and the rule.
Result<DetectorOptions> load_detector_options(const std::string& path);

}  // namespace bpa
