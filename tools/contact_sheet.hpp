// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/image_file.hpp"
#include "core/model/library.hpp"
#include "core/result/interpretation.hpp"

namespace bpa::cli {

/// A picture of a frame and how the result did in it.
struct AnnotatedFrame {
  io::ColorImage image;
  int found = 0;   ///< Of the instances that count.
  int missed = 0;  ///< Likewise.
  int wrong = 0;   ///< False reports.
};

/// Truth (left) beside the result (right). Instances that nothing was found for are outlined in red
/// as MISSED on the left, placements that are not right (2.5 cm, π/16 modulo symmetry) in red as
/// FALSE on the right. Objects that the library does not hold cannot be drawn and are left out.
AnnotatedFrame truth_beside_result(const Frame& frame, const std::vector<io::BopInstance>& truth,
                                   const Interpretation& result, const ModelLibrary& library,
                                   const std::string& caption);

/// The indices of frames, those with the most misses and false reports first, in order where equal.
std::vector<std::size_t> worst_first(const std::vector<AnnotatedFrame>& frames);

/// Colour (left) beside depth (right): violet is far, red near, each band of brightness is 6 cm,
/// and black has no depth.
io::ColorImage color_beside_depth(const Frame& frame, const std::string& caption);

/// Images, all made as wide as `cell_width`, in a grid.
io::ColorImage contact_sheet(const std::vector<io::ColorImage>& images, int columns,
                             int cell_width);

}  // namespace bpa::cli
