// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "core/result/interpretation.hpp"
#include "core/result/track.hpp"
#include "core/track/tracker.hpp"

namespace bpa::server {

/// What the server follows objects with: track::Tracker with the models that searches use, or the
/// tests' stub. Its functions mean what the Tracker's do. Not thread-safe.
class ObjectTracker {
 public:
  virtual ~ObjectTracker() = default;

  virtual Result<TrackedFrame> track(std::shared_ptr<const Frame> frame,
                                     const std::optional<track::CameraPose>& camera) = 0;
  /// Stamps begin anew: all tracks end; ids go on.
  virtual void begin_anew() = 0;
  virtual Status add(const SceneInterpretations& found) = 0;
  virtual double changed_since(std::int64_t stamp_ns) const = 0;
  virtual std::vector<ExpectedPlacement> expected() const = 0;
  virtual Status rename(std::uint64_t id, const std::string& name) = 0;
  virtual Status hold(std::uint64_t id, bool held) = 0;
  virtual Status forget(std::uint64_t id) = 0;
  virtual void set_options(const track::TrackerOptions& options) = 0;
  virtual track::TrackerCounts counts() const = 0;
};

}  // namespace bpa::server
