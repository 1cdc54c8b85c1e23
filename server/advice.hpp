// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "core/base/log.hpp"
#include "core/cloud/frame.hpp"
#include "core/result/interpretation.hpp"

namespace bpa::server {

/// What the doctor says of frames in which little is found. Thread-safe.
class Advice {
 public:
  explicit Advice(LogHook log) : log_(std::move(log)) {}

  /// What is wrong with the frame of a result that says little; else empty. The doctor is asked
  /// once in 10 s; what he did not say before is logged.
  std::string on(const Frame& frame, const SceneInterpretations& result, double max_range_m);
  /// The same without asking him, which takes as long as a search: what he said before.
  std::string known(const Frame& frame, const SceneInterpretations& result) const;

 private:
  const LogHook log_;
  mutable std::mutex mutex_;
  std::string said_, camera_;  ///< The last time, of a frame of that frame_id.
  std::chrono::steady_clock::time_point asked_;
};

}  // namespace bpa::server
