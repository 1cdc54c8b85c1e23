// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/cloud/surface_map.hpp"
#include "core/geometry/symmetry.hpp"
#include "core/model/object_model.hpp"
#include "core/score/predicted_surface.hpp"
#include "core/segment/super_pixels.hpp"

// How a placement fits the super-pixels (paper V.8).

namespace bpa::score {

/// A super-pixel that a placement touches.
struct SegmentMatch {
  int segment = 0;         ///< Index into segmentation.segments.
  int explained = 0;       ///< Its pixels within 3 cm of the predicted depth.
  double probability = 0;  ///< That it belongs to the model: the share of its points within 1 cm
                           ///< and the angle below of the closest model point.
  double distance = -1;    ///< Average truncated log-likelihood of its points' distances to the
                           ///< closest model points, standard deviation 1 cm, in [-1, 0].
};

struct SegmentMatchOptions {
  int points = 30;                        ///< Evaluated in each segment, evenly spread.
  double max_angle = kPoseTolerance_rad;  ///< Radians, between normals (paper section V).
};

/// The super-pixels with a pixel that the placement explains, by index. This is step 1 of the
/// paper's segment alignment too (V.6).
std::vector<SegmentMatch> match_segments(const segment::Segmentation& segmentation,
                                         const SurfaceMap& map, const ObjectModel& model,
                                         const Pose& camera_from_object,
                                         const PredictedSurface& predicted,
                                         const SegmentMatchOptions& options = {});

/// Segment score: how close the points of the touched segments, also those beyond the predicted
/// outline, are to the model. The average of SegmentMatch::distance weighted by `explained`, in
/// [-1, 0]; -1 without any match.
double segment_score(const std::vector<SegmentMatch>& matches);

/// Segment affinity score: how consistent the assigned segments are with the boundaries of objects.
/// Two touching segments of the model should have a high affinity; a segment of the model and one
/// of another object, a low one. The average log-likelihood over the contacts, in [-1, 0]. Each is
/// weighted by the probability that at least one side belongs to the model. -1 if no segment does.
double segment_affinity_score(const segment::Segmentation& segmentation,
                              const std::vector<SegmentMatch>& matches);

}  // namespace bpa::score
