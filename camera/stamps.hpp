// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

// The time stamps of a device: on the host's clock, and of frames that belong together.

namespace bpa::camera {

/// Maps the time stamps of a device to the host's clock.
///
/// A frame arrives some time after its exposure, never before: arrival = stamp + offset + delay.
/// The smallest difference seen is the offset with the least delay, so it is kept. Since clocks
/// drift apart, it may grow by 100 ppm of the elapsed time (crystals are within 50 ppm). The
/// remaining error is the device's shortest delay (exposure, transfer), which is not seen here.
/// Stamps stay as evenly spaced as the device made them, under any load.
class HostClock {
 public:
  /// The host's time of a device stamp that arrived at `arrival_ns`. A stamp that goes back, or is
  /// off by over 2 s, resets the offset. Examples: a looped recording, a device plugged in again.
  std::int64_t map(std::int64_t device_us, std::int64_t arrival_ns) {
    const std::int64_t device_ns = device_us * 1000;
    const std::int64_t difference = arrival_ns - device_ns;
    const bool again =
        !offset_ns_ || device_ns < last_device_ns_ || difference - *offset_ns_ > kRestartNs;
    if (again || difference < *offset_ns_) {
      offset_ns_ = difference;
    } else {
      offset_ns_ = std::min(difference, *offset_ns_ + (device_ns - last_device_ns_) / 10000);
    }
    last_device_ns_ = device_ns;
    return device_ns + *offset_ns_;
  }

 private:
  static constexpr std::int64_t kRestartNs = 2'000'000'000;
  std::optional<std::int64_t> offset_ns_;
  std::int64_t last_device_ns_ = 0;
};

/// Puts the depth and colour frames of one device together by its own time stamps. Holds one frame
/// of each kind: a newer one takes the place of one without a partner. `Image` is cheap to move.
template <class Image>
class FramePairs {
 public:
  /// Frames belong together when their stamps differ by no more than `tolerance_us`.
  explicit FramePairs(std::int64_t tolerance_us) : tolerance_us_(tolerance_us) {}

  struct Pair {
    Image depth;
    Image color;
  };

  void add_depth(Image image, std::int64_t stamp_us) { depth_.emplace(std::move(image), stamp_us); }
  void add_color(Image image, std::int64_t stamp_us) { color_.emplace(std::move(image), stamp_us); }

  /// The pair, if there is one now. Drops what is too old to find a partner.
  std::optional<Pair> take() {
    if (!depth_ || !color_) return std::nullopt;
    const std::int64_t apart = depth_->second - color_->second;
    if (apart > tolerance_us_) color_.reset();
    if (apart < -tolerance_us_) depth_.reset();
    if (!depth_ || !color_) return std::nullopt;
    Pair pair{std::move(depth_->first), std::move(color_->first)};
    clear();
    return pair;
  }
  /// Takes the depth frame without waiting for colour.
  std::optional<std::pair<Image, std::int64_t>> take_depth() { return std::exchange(depth_, {}); }

  /// Forgets what waits (streams started again).
  void clear() {
    depth_.reset();
    color_.reset();
  }

 private:
  std::int64_t tolerance_us_;
  std::optional<std::pair<Image, std::int64_t>> depth_;
  std::optional<std::pair<Image, std::int64_t>> color_;
};

}  // namespace bpa::camera
