// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <bpa/core/base/options.hpp>

namespace bpa {

/// Every setting of the detector. The defaults are meant for a Kinect-class sensor and household
/// objects; config/detector.yaml lists them all.
struct DetectorOptions {
  double max_range_m = 2.5;
  double min_probability = 0.5;

  template <class Visitor>
  void visit_fields(Visitor&& visit) {
    visit("max_range_m", max_range_m,
          FieldRule{0.2, 20, "Surface further away than this is ignored."});
    visit("min_probability", min_probability,
          FieldRule{0, 1, "Placements less probable than this are not reported."});
  }
};

/// Reads a YAML file that overrides some defaults. Fails with not_found, or with invalid_argument
/// naming the file, the line, the key (unknown keys are errors), the value and the rule.
Result<DetectorOptions> load_detector_options(const std::string& path);

}  // namespace bpa
