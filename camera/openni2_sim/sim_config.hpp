// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>

// What the simulated device shows and how it behaves. The environment variable BPA_SIM names
//
//   a folder in the BOP layout (`bpa simulate scenes` makes one), whose frames are shown in turn,
//   or a YAML file that is read again whenever it changes, so that faults can be tried:
//
//     scenes: DIR                 the folder, relative to the file
//     split: test
//     plugged: true               false: the device is not there (pulled out)
//     deliver: true               false: streams bring no frames any more
//     deliver_color: true         false: depth comes without colour
//     wedged: false               true: calls into the driver do not return
//     color_sensor: true          false: a device without a colour camera
//     fine_depth: false           true: depth in 0.1 mm only
//     registration: device        pretended: says that it registers and does not; none: cannot
//
// Without BPA_SIM there is no device.

namespace bpa::sim_driver {

enum class Registration { device, pretended, none };

/// The settings now. Thread-safe; those that are no atomics do not change after the first reading.
class SimConfig {
 public:
  /// Reads what BPA_SIM names.
  SimConfig();

  /// Reads the file again; a file that cannot be read (half written, say) changes nothing.
  void refresh();
  /// Waits as long as the driver is wedged.
  void pass() const;

  std::string scenes;  ///< Empty: there is no device.
  std::string split = "test";
  std::atomic<bool> plugged{true};
  std::atomic<bool> deliver{true};
  std::atomic<bool> deliver_color{true};
  std::atomic<bool> wedged{false};
  std::atomic<bool> color_sensor{true};
  bool fine_depth = false;
  std::atomic<Registration> registration{Registration::device};

 private:
  std::string file_;
  std::string text_;  ///< Of the file, as read last.
};

}  // namespace bpa::sim_driver
