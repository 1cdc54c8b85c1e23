// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "camera/camera_device.hpp"
#include "camera/camera_options.hpp"
#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "ros/bag_frames.hpp"

namespace bpa::camera {

inline constexpr const char* kBagSource = "bag:";

/// Takes the transforms that a recording of ROS 2 holds, their stamps as of the images.
using OnTransforms = ros::BagFrames::OnTransforms;

/// What opens the camera that `options.source` names; `invalid_argument` when it names none.
Result<OpenCamera> camera_of(const CameraOptions& options, const LogHook& log,
                             const OnTransforms& on_transforms = nullptr);

/// Whether capture.every_frame applies: recordings and data sets wait, sensors do not.
bool is_paced(const CameraOptions& options);
/// Whether a source is a recording of OpenNI2, a file *.oni.
bool is_recording(const std::string& source);

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

/// A text for people: the OpenNI2 devices, their modes and faults, and the USB depth sensors that
/// OpenNI2 does not serve. Opens each device for a moment. Fails when OpenNI2 has no drivers.
Result<std::string> list_devices();

/// Opens and starts a device of OpenNI2: modes, no mirroring, depth and colour in step, depth
/// registered to colour. `uri`: empty for the first device found, or the path of a recording.
/// Checks a recording before OpenNI2 sees it. Loads OpenNI2 if needed. `unavailable` when there is
/// no such device, `invalid_argument` when a setting does not fit it, `corrupt` for a damaged
/// recording.
OpenCamera openni2_camera(const std::string& uri, const CameraOptions& options, LogHook log);

/// The frames of a data set in the BOP layout (its split "test"; FOLDER:SPLIT names another), in
/// order, 30 a second times capture.speed.
Result<std::unique_ptr<CameraDevice>> open_bop_camera(const std::string& folder,
                                                      const CameraOptions& options);

/// A recording of ROS 2, played in its own time times capture.speed.
Result<std::unique_ptr<CameraDevice>> open_bag_camera(const CameraOptions& options,
                                                      const OnTransforms& on_transforms);

/// A frame as a camera delivers it, without its stamp and frame_id.
SensorImages images_of(Frame frame, bool with_color);

}  // namespace bpa::camera
