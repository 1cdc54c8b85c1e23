// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/draw/annotate.hpp"
#include "core/geometry/pose.hpp"
#include "core/io/image_file.hpp"

namespace bpa::draw {

/// Poses of one model that are drawn in one style.
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
io::ColorImage poses(const Frame& frame, const ObjectModel& model,
                     const std::vector<DrawnPoses>& groups, const DrawPosesOptions& options = {});

/// One pose of a model (green, camera_from_object) beside true ones (dashed in white): in the whole
/// frame on the left, its surroundings enlarged on the right.
io::ColorImage pose_from_near(const Frame& frame, const ObjectModel& model, const Pose& pose,
                              const std::vector<Pose>& truths);

}  // namespace bpa::draw
