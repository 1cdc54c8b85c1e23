// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"

namespace bpa::server {

/// The part of a message that kept it from becoming a frame.
enum class RejectionCause { camera, distortion, depth, color, cloud, priors, frame };

/// Names of the causes, by number; `frame`: too few depths, or a mask or region that does not fit.
inline constexpr const char* kRejectionCauses[] = {"camera", "distortion", "depth", "color",
                                                   "cloud",  "priors",     "frame"};

/// A frame, or why there is none.
class DecodedFrame : public Result<Frame> {
 public:
  DecodedFrame(Frame frame) : Result(std::move(frame)) {}  // NOLINT: implicit on purpose
  DecodedFrame(RejectionCause cause, Status status) : Result(std::move(status)), cause_(cause) {}

  /// Of no meaning when ok().
  RejectionCause cause() const { return cause_; }

 private:
  RejectionCause cause_ = RejectionCause::frame;
};

}  // namespace bpa::server
