// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/options.hpp"
#include "core/base/status.hpp"

namespace bpa::camera {

/// A sensor on this machine, a recording or a data set.
struct CameraOptions {
  std::string source;
  std::string depth_mode = "640x480@30";
  std::string color_mode = "640x480@30";
  bool color = true;
  std::string registration = "auto";
  double baseline_mm = 25;
  std::string calibration;
  std::string depth_calibration;
  bool auto_exposure = true;
  bool auto_white_balance = true;
  int exposure = 0;
  int gain = 0;
  double speed = 1;
  bool loop = false;
  int start_frame = 0;
  bool every_frame = false;
  double timeout_ms = 3000;
  double retry_ms = 1000;

  void visit_fields(auto&& visit) {
    visit("source", source,
          {0, 0,
           "openni2 (the first sensor), openni2:URI, a recording FILE.oni, or a data set "
           "bop:FOLDER; empty: none. With a source, camera topics are not subscribed to."});
    visit("depth_mode", depth_mode, {0, 0, "WIDTHxHEIGHT@RATE of a sensor's depth."});
    visit("color_mode", color_mode, {0, 0, "WIDTHxHEIGHT@RATE of a sensor's colour."});
    visit("color", color, {0, 0, "Take colour images beside depth."});
    visit("registration", registration,
          {0, 0,
           "Who registers depth to colour: auto (the device, and if it does not, the "
           "server), device, software, off."});
    visit("baseline_mm", baseline_mm,
          {0, 200,
           "Distance in mm from the depth camera to the colour camera on its right. For "
           "software registration without the device's own value."});
    visit("calibration", calibration,
          {0, 0,
           "ROS camera_info YAML of the colour camera; empty: from the device's field of "
           "view."});
    visit("depth_calibration", depth_calibration,
          {0, 0,
           "ROS camera_info YAML of the depth camera, for software registration; empty: "
           "from the device's field of view."});
    visit("auto_exposure", auto_exposure, {0, 0, "The sensor sets its exposure."});
    visit("auto_white_balance", auto_white_balance, {0, 0, "The sensor sets its white balance."});
    visit("exposure", exposure,
          {0, 1e6, "In the sensor's unit, without auto_exposure; 0: unchanged."});
    visit("gain", gain, {0, 1e6, "In the sensor's unit, without auto_exposure; 0: unchanged."});
    visit("speed", speed,
          {0.01, 100,
           "Playback rate of recordings and data sets; 1: as recorded (data sets: 30 Hz)."});
    visit("loop", loop, {0, 0, "Repeat recordings and data sets at their end."});
    visit("start_frame", start_frame,
          {0, 1e9, "First frame of a recording or data set to show; they count from 1."});
    visit("every_frame", every_frame,
          {0, 0,
           "Recordings and data sets wait with the next frame until the search has taken "
           "the last one."});
    visit("timeout_ms", timeout_ms,
          {100, 60000,
           "Milliseconds without frames after which a sensor is opened again. Driver calls "
           "that take as long are reported."});
    visit("retry_ms", retry_ms,
          {10, 60000, "Milliseconds between attempts to open a sensor that is not there."});
  }
};

/// The rules that visit_fields cannot say: the words of source, modes and registration. Messages
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
