// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "core/geometry/pose.hpp"

// The candidates of one model after each stage, for training, experiments and pictures.

namespace bpa {

/// Poses that one stage rejected for one reason.
struct Rejected {
  std::string_view reason;
  std::vector<FastPose> poses;
};

struct TraceStage {
  std::string_view name;
  std::string_view title;       ///< For people.
  std::string_view text;        ///< What the stage does, for people.
  std::vector<FastPose> poses;  ///< The candidates after the stage.
  double milliseconds = 0;
  std::vector<Rejected> rejected;

  void reject(std::string_view reason, const FastPose& pose);
};

struct ObjectTrace {
  std::vector<TraceStage> stages;  ///< In the order of detection_stages().
};

}  // namespace bpa
