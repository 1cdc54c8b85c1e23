// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/draw/annotate.hpp"
#include "core/io/image_file.hpp"

// Pictures put together, with words. OpenCV's fonts know ASCII only.

namespace bpa::draw {

/// One entry of a legend.
struct LegendEntry {
  Rgb color{};
  std::string text;
};

/// The picture under a title and over its legend, if any; the picture alone for an empty title.
io::ColorImage with_words(const io::ColorImage& picture, const std::string& title,
                          const std::vector<LegendEntry>& legend = {});

/// Two pictures of one height beside each other.
io::ColorImage beside(const io::ColorImage& left, const io::ColorImage& right);

/// Pictures, all made `cell_width` pixels wide, in a grid. Where that is larger than an image may
/// be (io::kMaxImageSide), there are more columns, and cells are smaller.
io::ColorImage contact_sheet(const std::vector<io::ColorImage>& pictures, int columns,
                             int cell_width);

/// Depth is red at 0.5 m and violet at 2.5 m; a band of brightness is 6 cm; pixels without depth
/// are black.
io::ColorImage depth_picture(const Frame& frame);

/// Colour (left) beside depth (right).
io::ColorImage color_beside_depth(const Frame& frame, const std::string& caption);

/// The model in its colours from one corner, `side` x `side` pixels, with symmetry axes (blue).
io::ColorImage model_thumbnail(const ObjectModel& model, int side);

/// A sheet that shows a model from six sides in its colours, with range edges (cyan) and symmetry
/// axes (blue). Also its curvature, the variance of its normals and its noise curves.
io::ColorImage model_sheet(const ObjectModel& model);

}  // namespace bpa::draw
