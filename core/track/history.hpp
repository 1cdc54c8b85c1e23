// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/track/association.hpp"

namespace bpa::track {

inline double seconds(std::int64_t nanoseconds) { return 1e-9 * static_cast<double>(nanoseconds); }

/// What is remembered of a frame, for results of searches that come later.
struct FrameRecord {
  std::int64_t stamp_ns = 0;
  Pose frame_from_camera;
  std::vector<TrackRecord> tracks;
  std::vector<float> depths;  ///< sampled_depths() of the whole frame.
};

/// A frame that new objects are followed through.
struct KeptFrame {
  std::shared_ptr<const Frame> frame;
  Pose frame_from_camera;
};

/// The last frames: what was tracked in each, and of some the images. Stamps rise.
class History {
 public:
  static constexpr double kRemembered_s = 10;  ///< Chosen by hand, as those of history.cpp.

  void remember(std::shared_ptr<const Frame> frame, const Pose& frame_from_camera,
                std::vector<TrackRecord> tracks);
  void clear();

  /// Null where the frame is not remembered.
  const FrameRecord* record_of(std::int64_t stamp_ns) const;
  /// There must be one.
  const FrameRecord& newest() const { return records_.back(); }
  /// The frames later than the stamp whose images are kept. Valid until remember().
  std::span<const KeptFrame> kept_after(std::int64_t stamp_ns) const;

 private:
  std::vector<FrameRecord> records_;
  std::vector<KeptFrame> kept_;
};

}  // namespace bpa::track
