// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/options.hpp"
#include "core/base/status.hpp"
#include "ros/bag_topics.hpp"

namespace bpa::camera {

/// A sensor on this machine, a recording or a data set.
struct CameraOptions {
  BPA_OPTION(std::string, source, "", (),
             "openni2 (the first sensor), openni2:URI, a recording FILE.oni, a data set "
             "bop:FOLDER, or a recording of ROS 2 bag:PATH (its folder, FILE.mcap or FILE.db3); "
             "empty: none. With a source, camera topics are not subscribed to.");
  BPA_OPTION(std::string, depth_mode, "640x480@30", (), "WIDTHxHEIGHT@RATE of a sensor's depth.");
  BPA_OPTION(std::string, color_mode, "640x480@30", (), "WIDTHxHEIGHT@RATE of a sensor's colour.");
  BPA_OPTION(bool, color, true, (), "Take colour images beside depth.");
  BPA_OPTION(std::string, registration, "auto", (),
             "Who registers depth to colour: auto (the device, and if it does not, the server), "
             "device, software, off.");
  BPA_OPTION(double, baseline_mm, 25, (0, 200),
             "Distance in mm from the depth camera to the colour camera on its right. For software "
             "registration without the device's own value.");
  BPA_OPTION(std::string, calibration, "", (),
             "ROS camera_info YAML of the colour camera; empty: from the device's field of view.");
  BPA_OPTION(std::string, depth_calibration, "", (),
             "ROS camera_info YAML of the depth camera, for software registration; empty: from the "
             "device's field of view.");
  BPA_OPTION(bool, auto_exposure, true, (), "The sensor sets its exposure.");
  BPA_OPTION(bool, auto_white_balance, true, (), "The sensor sets its white balance.");
  BPA_OPTION(int, exposure, 0, (0, 1e6),
             "In the sensor's unit, without auto_exposure; 0: unchanged.");
  BPA_OPTION(int, gain, 0, (0, 1e6), "In the sensor's unit, without auto_exposure; 0: unchanged.");
  BPA_OPTION(double, speed, 1, (0.01, 100),
             "Playback rate of recordings and data sets; 1: as recorded (data sets: 30 Hz).");
  BPA_OPTION(bool, loop, false, (), "Repeat recordings and data sets at their end.");
  BPA_OPTION(int, start_frame, 0, (0, 1e9),
             "First frame of a recording or data set to show; they count from 1.");
  BPA_OPTION(
      bool, every_frame, false, (),
      "Recordings and data sets wait with the next frame until the search has taken the last one.");
  BPA_INLINE_GROUP(ros::BagTopics, bag_topics);
  BPA_OPTION(double, timeout_ms, 3000, (100, 60000),
             "Milliseconds without frames after which a sensor is opened again. Driver calls that "
             "take as long are reported.");
  BPA_OPTION(double, retry_ms, 1000, (10, 60000),
             "Milliseconds between attempts to open a sensor that is not there.");
};

/// The rules that a FieldRule cannot say: the words of source, modes and registration. Messages
/// name the field as the server does, "capture.source".
Status check(const CameraOptions& options);

/// Size and rate of a stream, as settings write it: 640x480@30.
struct VideoMode {
  int width = 0;
  int height = 0;
  int fps = 0;

  bool operator==(const VideoMode&) const = default;
};

/// Reads "640x480@30"; nothing when it does not read so or a number is not in 1 to 8192.
std::optional<VideoMode> parse_video_mode(const std::string& text);
std::string to_string(const VideoMode& mode);
/// "640x480@30, 320x240@30": each once, in this order.
std::string list_of(const std::vector<VideoMode>& modes);

}  // namespace bpa::camera
