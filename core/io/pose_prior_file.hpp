// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/result/pose_prior.hpp"

namespace bpa::io {

/// Reads {"priors": [PRIOR, ...]}, where a PRIOR has
///
///   "model"                  the model's name;
///   "pose"                   {"rotation_wxyz": [4], "translation_m": [3]}: the most probable one;
///   "position_sigma_m"       standard deviation of the position along each axis, or
///   "position_covariance_m2" [9] row by row. Neither: the position is unknown.
///   "rotation_sigma_deg"     standard deviation of the rotation about each axis, or
///   "bingham"                {"axes": [12] row by row, 4 x 3, "concentrations": [3]}, as results
///                            have it; ignores the pose's rotation. Neither: unknown.
///   "weight"                 probability that the prior applies, in (0, 1]; default 0.95.
///
/// An empty path gives no priors. Fails with not_found, or with corrupt: no JSON, or an unknown,
/// missing or wrong field. The message names file, prior and problem. validate() checks numbers.
Result<std::vector<PosePrior>> read_pose_priors(const std::string& path);

/// The priors of such a file's text; `name` stands for the file in messages.
Result<std::vector<PosePrior>> parse_pose_priors(const std::string& text, std::string name);

}  // namespace bpa::io
