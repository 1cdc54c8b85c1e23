// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace bpa::camera {

/// Maps the time stamps of a device to the host's clock.
///
/// A frame arrives some time after its exposure, never before: arrival = stamp + offset + delay.
/// The smallest difference seen is the offset with the least delay, so it is kept; since clocks
/// drift apart, it may grow by 100 millionths of the time that passes (crystals are within 50). The
/// remaining error is the shortest delay of the device (its exposure and transfer time), which
/// cannot be seen from here. Stamps stay as evenly spaced as the device made them, whatever load
/// delays their arrival.
class HostClock {
 public:
  /// The host's time of a device stamp that arrived at `arrival_ns`. A stamp that goes back, or is
  /// off by more than 2 s, means a new start (a recording that repeats, a device plugged in again).
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

}  // namespace bpa::camera
