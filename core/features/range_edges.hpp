// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/options.hpp"
#include "core/cloud/image.hpp"
#include "core/cloud/surface_map.hpp"

namespace bpa {

/// What a pixel is at a depth discontinuity.
enum class RangeEdge : std::uint8_t {
  none = 0,
  occluding = 1,  ///< On the nearer surface: something ends here.
  occluded = 2,   ///< On the further surface: something is hidden from here on.
};

struct RangeEdgeOptions {
  int max_gap_px = 20;  ///< Chosen by hand.
  int num_threads = 0;  ///< 0: one for each core.

  template <class Visitor>
  void visit_fields(Visitor&& visit) {
    visit("max_gap_px", max_gap_px, FieldRule{0, 200, "Pixels without depth that an edge spans."});
  }
};

/// Depth discontinuities (paper section V), from each pixel to the next one with a depth in the
/// four directions of the grid. See surface_breaks() for what is one. Sensors with a projector see
/// nothing beside an edge; the gap does not count, unless it is longer than max_gap_px.
Image<RangeEdge> range_edges(const SurfaceMap& map, const RangeEdgeOptions& options = {});

}  // namespace bpa
