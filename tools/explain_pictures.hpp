// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/detect/single_object.hpp"
#include "core/io/image_file.hpp"
#include "core/pipeline/annotate.hpp"

// Pictures with words around them, for bpa detect --explain.

namespace bpa::cli {

/// One entry of a legend.
struct LegendEntry {
  Rgb color{};
  std::string text;
};

/// The picture under a title and over its legend. Both in ASCII.
io::ColorImage with_words(const io::ColorImage& picture, const std::string& title,
                          const std::vector<LegendEntry>& legend);

/// Two pictures of one height beside each other.
io::ColorImage beside(const io::ColorImage& left, const io::ColorImage& right);

/// A placement: in the frame and from near, beside what each score component is and adds to the
/// log odds in `layer`. `truths` are dashed in white.
io::ColorImage placement_sheet(const Frame& frame, const Candidate& candidate,
                               const ScoreLayer& layer, const std::vector<Pose>& truths);

}  // namespace bpa::cli
