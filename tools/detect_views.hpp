// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/io/results.hpp"
#include "tools/search.hpp"

namespace bpa::cli {

/// What is asked of every view.
struct ViewsQuestion {
  DetectRequest request;  ///< Priors are in the fixed frame.
  RegionOfInterest roi;
  std::vector<std::uint8_t> mask;
};

/// Searches the frames of each scene --views at a time and joins them. Cameras are where --poses
/// says, in the order of the frames, else where cam_R_w2c of the data set says. Results are in the
/// fixed frame and named by the first frame of theirs. Prints warnings; calls `print` with each
/// result as it comes. Writes pictures of all views for --annotate.
std::vector<io::FrameResult> detect_joined(
    const DetectArguments& arguments, const std::vector<io::BopFrame>& entries,
    const Detector& detector, const ViewsQuestion& question,
    const std::function<void(const std::string& name, const io::FrameResult&)>& print);

}  // namespace bpa::cli
