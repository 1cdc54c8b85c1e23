// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/cloud/image.hpp"
#include "core/geometry/pose.hpp"
#include "core/model/object_model.hpp"
#include "core/score/pose_check.hpp"
#include "core/score/predicted_surface.hpp"

namespace bpa::score {

struct RandomWalkOptions {
  int walks = 60;
  int steps = 40;  ///< Of one pixel each, some of which an edge stops.
  std::uint64_t seed = 0;
};

/// Random walk score (paper V.8). Walks start at observed points within 1 cm of the prediction,
/// spread evenly. They go from pixel to neighbouring pixel of the observed surface. A step onto a
/// pixel of edge likelihood e has probability (1 - e)^2, so walks stay within object boundaries.
/// Their ends should be on the model's surface. The score is the average truncated log-likelihood
/// of the distance to the closest model point, standard deviation 1 cm. In [-1, 0]; -1 where
/// nothing is explained.
double random_walk_score(const CheckImage& image, const Image<float>& edges,
                         const ObjectModel& model, const Pose& camera_from_object,
                         const PredictedSurface& predicted, const RandomWalkOptions& options = {});

}  // namespace bpa::score
