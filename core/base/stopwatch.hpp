// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <limits>

namespace bpa {

/// Wall-clock time since construction or the last lap, on the monotonic clock.
class Stopwatch {
 public:
  double milliseconds() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }
  double seconds() const { return milliseconds() * 1e-3; }
  /// The milliseconds so far; starts again from zero.
  double lap_milliseconds() {
    const double elapsed = milliseconds();
    start_ = Clock::now();
    return elapsed;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// A moment after which work should stop. The default never passes.
class Deadline {
 public:
  Deadline() = default;
  /// `milliseconds` from now; 0 or less: never.
  static Deadline after(double milliseconds) {
    Deadline out;
    if (milliseconds > 0) out.end_ = Clock::now() + to_duration(milliseconds);
    return out;
  }
  bool never() const { return end_ == Clock::time_point::max(); }
  bool passed() const { return !never() && Clock::now() >= end_; }
  /// Not below 0; infinite if the deadline never passes.
  double milliseconds_left() const {
    if (never()) return std::numeric_limits<double>::infinity();
    const std::chrono::duration<double, std::milli> left = end_ - Clock::now();
    return left.count() > 0 ? left.count() : 0;
  }
  /// The moment by which `share` (0 to 1) of the time that is left has passed.
  Deadline part(double share) const {
    if (never()) return *this;
    Deadline out;
    out.end_ = Clock::now() + to_duration(share * milliseconds_left());
    return out;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static Clock::duration to_duration(double milliseconds) {
    return std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double, std::milli>(milliseconds));
  }
  Clock::time_point end_ = Clock::time_point::max();
};

}  // namespace bpa
