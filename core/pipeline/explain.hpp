// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/features/edge_image.hpp"
#include "core/io/image_file.hpp"
#include "core/pipeline/annotate.hpp"
#include "core/score/segment_scores.hpp"
#include "core/segment/super_pixels.hpp"

// Pictures of what the detector makes of a frame, for people, ready for io::write_color_png. As
// large as the frame unless it says otherwise.

namespace bpa {

/// The three kinds of edges over the dimmed colour image: occluding range edges red, occluded ones
/// blue, curvature edges green, image edges yellow. Where there are several, the first of these.
io::ColorImage draw_edges(const Frame& frame, const SceneEdges& edges);

/// The edge image in grey: white is 1.
io::ColorImage draw_edge_image(const Frame& frame, const Image<float>& likelihood);

/// The borders of the super-pixels over the colour image, black where the surface goes on, white
/// where the affinity across the border is below one half.
io::ColorImage draw_segment_borders(const Frame& frame, const Segmentation& segmentation);

/// The super-pixels that a placement touches over the dimmed colour image, from red (does not
/// belong to the model) to green (does).
io::ColorImage draw_segment_matches(const Frame& frame, const Segmentation& segmentation,
                                    const std::vector<SegmentMatch>& matches);

/// Every super-pixel in its mean colour (without colour: shaded by its mean normal); black where
/// there is no surface.
io::ColorImage draw_segment_means(const Frame& frame, const Segmentation& segmentation);

/// Poses of one model that are drawn alike.
struct DrawnPoses {
  enum class Style {
    dots,      ///< A dot in the model's middle.
    outlines,  ///< Of the model's silhouette.
    bold,      ///< Thick outlines.
    dashed,    ///< Dashed outlines.
  };
  std::span<const FastPose> poses;  ///< Best first: those are drawn last and brightest.
  Rgb color{};
  Style style = Style::outlines;
};

struct DrawPosesOptions {
  int min_width = 960;  ///< The frame is enlarged until it is as wide, pixels.
  bool dimmed = true;   ///< Show the frame darker and paler.
};

/// Poses of a model over the frame, later groups over earlier ones.
io::ColorImage draw_poses(const Frame& frame, const ObjectModel& model,
                          const std::vector<DrawnPoses>& groups,
                          const DrawPosesOptions& options = {});

/// Part of a frame, with the camera that sees just that. Only depth, colour and camera are kept.
/// `part` must lie in the frame.
Frame crop(const Frame& frame, const RegionOfInterest& part);

}  // namespace bpa
