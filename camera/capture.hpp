// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <thread>

#include "camera/camera_device.hpp"
#include "core/base/clock.hpp"
#include "core/base/log.hpp"
#include "core/base/status.hpp"

namespace bpa::camera {

/// How a camera is doing.
struct CaptureStatus {
  LogLevel level = LogLevel::error;  ///< info: images come; warning: with a flaw; error: none.
  std::string text = "the camera is being opened";
  std::string device;        ///< Name of the device, once it was open.
  std::string last_attempt;  ///< Why the last attempt to open it failed; empty: it did not.
  std::uint64_t frames = 0;  ///< Sets of images so far.
  std::uint64_t opened = 0;  ///< How often the device was opened.
  std::string recording;     ///< File that is being written; empty: none.
};

/// A recording ends when it reaches one of these.
struct RecordingLimits {
  std::chrono::milliseconds time{};
  std::uint64_t bytes = std::numeric_limits<std::uint64_t>::max();
};

struct CaptureTimes {
  /// Without frames for this long, a camera is opened again; a driver's call this long is reported.
  std::chrono::milliseconds timeout{3000};
  std::chrono::milliseconds retry{1000};  ///< Between attempts to open.
};

/// Keeps a camera open and hands its images on, on a thread of its own. A camera that is not there,
/// is pulled out or stops delivering is opened again until it is back; what is wrong is logged when
/// it begins and once more when it ends. A second thread watches over the first: a driver that does
/// not return from a call is reported, and left behind when the server stops.
class Capture {
 public:
  /// `on_images` and `ready` are called on the capture thread, never after the destructor. While
  /// `ready` (which may be empty) says false, the camera is not asked for images.
  Capture(OpenCamera open, const CaptureTimes& times, std::function<void(SensorImages&&)> on_images,
          std::function<bool()> ready, LogHook log,
          std::shared_ptr<WaitableClock> clock = steady_clock());
  ~Capture();
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;

  CaptureStatus status() const;

  using Recorded = std::function<void(const Result<RecordingSummary>&)>;
  /// Records to a file of this machine, up to its limits. `done` is called once, from another
  /// thread: `busy` while a recording runs, `unavailable` without a camera or when it hangs.
  void start_recording(const std::string& path, const RecordingLimits& limits, Recorded done);
  /// Ends it; also gives the summary of one that ended by itself since, or why it failed (such as a
  /// full disk). Otherwise `not_found`.
  void stop_recording(Recorded done);

 private:
  class Impl;
  std::shared_ptr<Impl> impl_;  ///< A thread that is left behind keeps it alive.
  std::thread watchdog_;
};

}  // namespace bpa::camera
