// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/cloud/frame.hpp"
#include "core/doctor/finding.hpp"

// What is wrong with a frame. The limits let good frames of Kinect-class sensors, real and
// simulated, pass without a finding (tests/core/doctor).

namespace bpa::doctor {

/// Where the colour edges of depth edges lie: that of the depth edge at pixel p at
/// c + scale * (p - c) + (right, down), c the centre of the image.
struct EdgeOffset {
  double right = 0;  ///< Pixels.
  double down = 0;   ///< Pixels.
  double scale = 1;
  double pixels = 0;            ///< Mean displacement of the depth edges.
  double agreement = 0;         ///< How many depth edges are on colour edges after it, 0 to 1.
  double agreement_now = 0;     ///< The same for the frame as it is.
  double agreement_chance = 0;  ///< The same on average over all offsets.
};

/// The offset of best agreement; of equal ones any. Nothing without colour or with too few depth
/// edges to tell. The frame must be valid (validate(Frame)).
std::optional<EdgeOffset> find_edge_offset(const Frame& frame, int num_threads = 0);

/// What is wrong with a frame whose depth may hold anything; that is, before clean_depth().
/// `max_range_m`: surface farther away is not searched.
Findings check_frame(const Frame& frame, double max_range_m, int num_threads = 0);

/// clean_depth() and validate(). Where a frame cannot be searched, the message is the worst of what
/// check_frame() says, who sees the depths that are dropped.
Status make_searchable(Frame& frame, double max_range_m, int num_threads = 0);

}  // namespace bpa::doctor
