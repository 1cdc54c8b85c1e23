// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "core/detect/candidate.hpp"
#include "core/detect/search.hpp"

namespace bpa {

/// Intermediate results of the detection in one frame, for training, experiments and pictures.
struct FrameTrace {
  SceneFeatures scene;
  std::vector<std::shared_ptr<const ObjectModel>> models;  ///< Searched for.
  std::vector<ObjectTrace> objects;                        ///< One for each model.
  std::vector<Candidate> candidates;                       ///< Of all models.
};

}  // namespace bpa
