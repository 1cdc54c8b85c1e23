// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/options.hpp"

namespace bpa {

/// How several views of one scene are joined.
struct ViewsOptions {
  BPA_OPTION(bool, align_cameras, true, (),
             "Move the cameras' poses so that the surfaces of their frames agree.");
  BPA_OPTION(double, independence, 0.7, (0, 1),
             "How much views count by themselves: 1 adds the log odds of all, 0 takes their mean.");
  double empty_log_odds = -4;  ///< Log odds of a placement before any view is looked at.
  double min_pooled_score =
      -6;  ///< What one view gives at least this log odds is scored in the other views.
  BPA_OPTION(double, same_position_m, 0.015, (0.001, 0.1),
             "Placements of two views this near are one placement, metres.");
  BPA_OPTION(double, same_angle_rad, 0.1, (0.01, 1),
             "Placements of two views this near are one placement, radians.");
  BPA_OPTION(double, position_sigma_m, 0.003, (0, 0.1),
             "Expected error of a camera's position, standard deviation, metres.");
  BPA_OPTION(double, angle_sigma_deg, 0.2, (0, 10),
             "Expected error of a camera's orientation, standard deviation, degrees.");
  BPA_OPTION(double, warn_position_m, 0.004, (0.0005, 1),
             "Cameras whose surfaces are further apart are warned of, metres.");
  BPA_OPTION(double, warn_angle_deg, 0.4, (0.05, 90),
             "Cameras whose surfaces are turned further are warned of, degrees.");
};

}  // namespace bpa
