// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/io/image_file.hpp"
#include "core/model/library.hpp"
#include "core/result/interpretation.hpp"

namespace bpa::draw {

using Rgb = std::array<std::uint8_t, 3>;

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

/// The frame's colour image (depth as grey where it has none) with, for each object, the outline of
/// its projected surface, a translucent fill and its label; nearer objects over further ones.
/// Labels are moved so that they do not cover each other as long as there is room.
io::ColorImage objects(const Frame& frame, const std::vector<DrawnObject>& drawn);

/// A placement with its name and probability, in the colour of its model number. Points into
/// `model`.
DrawnObject placed(const Placement& placement, const ObjectModel& model);

/// The placements of an interpretation with names and probabilities. Placements whose model the
/// library does not hold are left out.
io::ColorImage annotate(const Frame& frame, const Interpretation& interpretation,
                        const ModelLibrary& library);

}  // namespace bpa::draw
