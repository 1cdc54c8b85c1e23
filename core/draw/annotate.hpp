// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/cloud/image.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/image_file.hpp"
#include "core/model/library.hpp"
#include "core/result/interpretation.hpp"

namespace bpa::draw {

using Rgb = std::array<std::uint8_t, 3>;

/// The pixels that an object would cover if nothing were in front of it.
struct Silhouette {
  int left = 0;              ///< Column of the mask's first pixel in the image.
  int top = 0;               ///< Row of it.
  Image<std::uint8_t> mask;  ///< 255 on the object, else 0; empty if it is out of sight.
};

/// Draws the points of `surface` (object frame) as discs that reach their neighbours. Models hold
/// points only; where there is a mesh, eval::render_depth is exact.
Silhouette silhouette(const Camera& camera, const PointCloud& surface,
                      const Pose& camera_from_object);

/// One object to draw into an image.
struct DrawnObject {
  const PointCloud* surface = nullptr;  ///< Object frame; not owned.
  Pose camera_from_object;
  std::string label;
  Rgb color{};
  bool emphasised = false;  ///< Thick outline without fill, for errors.
};

/// A colour for each object number, far apart for neighbouring numbers, the same in every picture.
Rgb object_color(int number);

/// Draws each object over the frame's colour image (depth as grey without colour): the outline of
/// its projected surface, a translucent fill and its label. Nearer objects cover further ones.
/// Labels are moved apart while there is room.
io::ColorImage objects(const Frame& frame, const std::vector<DrawnObject>& drawn);

/// A placement with its name and probability, coloured by its model number. Points into `model`.
DrawnObject placed(const Placement& placement, const ObjectModel& model);

/// The placements of an interpretation with names and probabilities, of models in the library.
io::ColorImage annotate(const Frame& frame, const Interpretation& interpretation,
                        const ModelLibrary& library);

/// One picture of a result: colour beside depth under `caption`; then, for the best interpretation
/// and the second, outlines with probabilities beside the models in their colours.
io::ColorImage summary(const Frame& frame, const std::vector<Interpretation>& interpretations,
                       const ModelLibrary& library, const std::string& caption);

/// A picture of a frame, and how many instances and placements are which.
struct JudgedFrame {
  io::ColorImage picture;
  int found = 0;   ///< Instances of which 10 % or more is visible, with a right placement.
  int missed = 0;  ///< The same without a right placement.
  int wrong = 0;   ///< False positives.
};

/// Truth (left) beside the result (right). MISSED, in red on the left: missed instances. FALSE, in
/// red on the right: false positives (eval::right_cost). Objects that the library lacks are left
/// out.
JudgedFrame truth_beside_result(const Frame& frame, const std::vector<io::BopInstance>& truth,
                                const Interpretation& result, const ModelLibrary& library,
                                const std::string& caption);

/// The indices of frames by falling number of errors, in order where equal.
std::vector<std::size_t> worst_first(const std::vector<JudgedFrame>& frames);

}  // namespace bpa::draw
