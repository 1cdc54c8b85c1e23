// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/cloud/frame.hpp"
#include "core/features/edges.hpp"
#include "core/io/image_file.hpp"
#include "core/score/segment_scores.hpp"
#include "core/segment/super_pixels.hpp"

// Pictures of the features that the detector reads from a frame, as large as the frame.

namespace bpa::draw {

/// The three kinds of edges over the dimmed colour image: occluding range edges red, occluded ones
/// blue, curvature edges green, image edges yellow. Where there are several, the first of these.
io::ColorImage edges(const Frame& frame, const features::SceneEdges& found);

/// The edge image in grey: white is 1.
io::ColorImage edge_image(const Frame& frame, const Image<float>& likelihood);

/// The borders of the super-pixels over the colour image. Black: the surface goes on. White: the
/// affinity across the border is below one half.
io::ColorImage segment_borders(const Frame& frame, const segment::Segmentation& segmentation);

/// The super-pixels that a placement touches over the dimmed image, from red (not its) to green.
io::ColorImage segment_matches(const Frame& frame, const segment::Segmentation& segmentation,
                               const std::vector<score::SegmentMatch>& matches);

/// Every super-pixel in its mean colour, without colour by its mean normal; black: no surface.
io::ColorImage segment_means(const Frame& frame, const segment::Segmentation& segmentation);

}  // namespace bpa::draw
