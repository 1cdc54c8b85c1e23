// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/options.hpp"

namespace bpa {

/// How several views of one scene are joined.
struct ViewsOptions {
  bool align_cameras = true;
  double independence = 0.7;
  double empty_log_odds = -4;
  double min_pooled_score = -6;
  double same_position_m = 0.015;
  double same_angle_rad = 0.1;
  double position_sigma_m = 0.003;
  double angle_sigma_deg = 0.2;
  double warn_position_m = 0.004;
  double warn_angle_deg = 0.4;

  void visit_fields(auto&& visit) {
    visit("align_cameras", align_cameras,
          {0, 1, "Move the cameras' poses so that the surfaces of their frames agree."});
    visit("independence", independence,
          {0, 1,
           "How much views count by themselves: 1 adds the log odds of all, 0 takes their mean."});
    visit("empty_log_odds", empty_log_odds,
          {-20, 0, "Log odds of a placement before any view is looked at."});
    visit("min_pooled_score", min_pooled_score,
          {-20, 20, "What one view gives at least this log odds is scored in the other views."});
    visit("same_position_m", same_position_m,
          {0.001, 0.1, "Placements of two views this near are one placement, metres."});
    visit("same_angle_rad", same_angle_rad,
          {0.01, 1, "Placements of two views this near are one placement, radians."});
    visit("position_sigma_m", position_sigma_m,
          {0, 0.1, "Expected error of a camera's position, standard deviation, metres."});
    visit("angle_sigma_deg", angle_sigma_deg,
          {0, 10, "Expected error of a camera's orientation, standard deviation, degrees."});
    visit("warn_position_m", warn_position_m,
          {0.0005, 1, "Cameras whose surfaces are further apart are warned of, metres."});
    visit("warn_angle_deg", warn_angle_deg,
          {0.05, 90, "Cameras whose surfaces are turned further are warned of, degrees."});
  }
};

}  // namespace bpa
