// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/eval/evaluation.hpp"

namespace bpa::eval {

/// Evaluates one frame. `result` may be null: nothing was reported.
Result<FrameOutcome> evaluate_frame(const io::BopFrame& frame, const EvalObjects& objects,
                                    const io::FrameResult* result,
                                    const EvaluationOptions& options);

}  // namespace bpa::eval
