// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <span>
#include <string>
#include <vector>

#include "core/cloud/frame.hpp"

// Combines the last depth images of a static camera and scene, pixel by pixel. Noise that is
// independent between frames shrinks with the root of their number. Holes are filled from frames
// with a depth there. Errors that all frames share stay: calibration, steps of disparity larger
// than the noise, surfaces that the sensor never sees. A moving object is seen as in the newest
// frame.

namespace bpa {

/// Two depths agree when they differ by at most this many standard deviations of the sensor's noise
/// there (depth_noise()).
constexpr float kFusionAgreement = 3;

/// The robust mean of a pixel's depths: of those that agree with the median. With an even number
/// the median is the lower middle one, so that no depth between two surfaces is invented.
struct AgreedDepth {
  float median = 0;  ///< metres
  float mean = 0;    ///< metres
  int agreeing = 0;  ///< How many depths agree with the median, which is one of them.
};
/// `depths`: at least one; metres, above 0; in any order, and left in another.
AgreedDepth agreed_depth(std::span<float> depths);

/// A frame whose depth is that of the frames so far.
struct FusedFrame {
  Frame frame;  ///< The newest with all that belongs to it, but for depth and Frame::fused.
  /// Why combining restarts here, such as "camera.fx changed from 525 to 600"; else empty.
  std::string restart;
};

/// Combines the depth of the last frames of one camera. Of each pixel:
///
///  - the robust mean of its depths, where the newest one is among those that agree;
///  - the newest, where it is not: something moved;
///  - without a newest depth, the robust mean of the others. At least half of all frames must have
///    one, and most of these must agree.
///
/// Restarts with another camera (size, frame_id, intrinsics by more than kSameCamera) and when
/// more than kMostMoved has moved. Not thread-safe.
class FrameFusion {
 public:
  /// The share of pixels whose newest depth agrees with under half of the earlier frames' depths.
  /// Of all pixels with depth in the newest frame and an earlier one.
  static constexpr double kMostMoved = 0.25;
  /// Pixels. Cameras that are estimated from clouds are not the same to the last bit.
  static constexpr double kSameCamera = 0.1;

  /// Combines up to `max_frames`, at least 1, from the next one on. 1 leaves frames as they are
  /// and keeps none.
  explicit FrameFusion(int max_frames = 1) { set_max_frames(max_frames); }
  void set_max_frames(int max_frames);

  /// Takes up the newest frame, which must be valid, its depth clean (clean_depth()). The same
  /// frames give the same depth for any number of threads.
  FusedFrame add(Frame frame, int num_threads = 0);

  /// Takes up a frame without comparing its depths, for when a newer one will follow before
  /// anything is asked. Returns FusedFrame::restart, which is about the camera alone then.
  std::string hold(const Frame& frame);

 private:
  std::string change_of(const Frame& frame) const;

  std::size_t max_frames_ = 1;
  Camera camera_;  ///< Of the frames that are held.
  std::string frame_id_;
  std::deque<std::vector<float>> depths_;  ///< Of the last frames, as they came; oldest first.
};

}  // namespace bpa
