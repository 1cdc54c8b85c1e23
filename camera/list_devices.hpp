// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/status.hpp"

namespace bpa::camera {

/// A depth sensor that is plugged in, whether or not a driver serves it.
struct UsbSensor {
  std::string place;  ///< Of sysfs, such as "1-4".
  std::string id;     ///< "045e:02ae".
  std::string name;
  std::string how;        ///< How it can be used, in a sentence.
  bool openni2 = false;   ///< Whether OpenNI2 can serve it.
  bool permitted = true;  ///< Whether this user may write to it; true when that cannot be seen.
};

/// The depth sensors that Linux lists under `sysfs` (/sys/bus/usb/devices), with their device files
/// under `devices` (/dev/bus/usb). Empty when there are none or no such folder.
std::vector<UsbSensor> usb_sensors(const std::string& sysfs, const std::string& devices);

/// The OpenNI2 devices with their modes and what is wrong with each, and the depth sensors on USB
/// that OpenNI2 does not serve, as text for people. Opens each device for a moment. Fails when
/// OpenNI2 has no drivers.
Result<std::string> list_devices();

}  // namespace bpa::camera
