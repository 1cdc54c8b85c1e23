// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <bpa/status.hpp>
#include <bpa/types.hpp>

namespace bpa::cli {

/// What --help says of --priors.
inline constexpr const char* kPriorsHelp =
    "what is known beforehand of the objects' poses, in the camera's frame: JSON, {\"priors\": "
    "[{\"model\": NAME, \"pose\": {\"rotation_wxyz\": [4], \"translation_m\": [3]}, "
    "\"position_sigma_m\": S, \"rotation_sigma_deg\": S, \"weight\": W}]}";

/// Reads the file that `bpa detect --priors` reads (core/pipeline/pose_prior_file.hpp says what is
/// in it); none for an empty path. Fails with not_found or corrupt, naming the file.
Result<std::vector<ExpectedPose>> read_priors(const std::string& path);

}  // namespace bpa::cli
