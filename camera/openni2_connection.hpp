// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include <openni2/OpenNI.h>

#include "camera/oni_file.hpp"
#include "camera/openni2_device.hpp"
#include "camera/openni2_library.hpp"
#include "core/base/status.hpp"

namespace bpa::camera {

/// An open device of OpenNI2 with its streams, closed in the order that drivers need. Only files
/// named openni2* include this.
class Openni2Connection : private openni::OpenNI::DeviceDisconnectedListener,
                          private openni::OpenNI::DeviceStateChangedListener {
 public:
  /// Opens the device, its registration switched off. `unavailable` when it is not there; for a
  /// recording also `not_found`, `corrupt` and `unsupported` (inspect_oni_file).
  static Result<std::unique_ptr<Openni2Connection>> open(std::shared_ptr<Openni2Library> library,
                                                         const Openni2Target& target);
  ~Openni2Connection() override;

  /// Name for people: the device's, or the recording's path.
  const std::string& name() const { return name_; }
  bool is_recording() const { return is_recording_; }
  /// What is in the recording; empty for a sensor.
  const OniFileInfo& file() const { return file_; }
  bool with_color() const { return color.isValid(); }
  /// Whether the sensor was pulled out.
  bool gone() const { return gone_; }
  /// Whether the recording is over; frames may still wait.
  bool ended() const { return ended_; }

  /// Has the device deliver depth and colour in pairs, or each by itself; false when it cannot. In
  /// pairs, OpenNI2 waits for ever unless both streams are read.
  bool set_in_step(bool in_step);
  bool in_step() const { return in_step_; }

  openni::Device device;
  openni::VideoStream depth;  ///< Not valid until bring-up makes it.
  openni::VideoStream color;  ///< Not valid without colour.

 private:
  explicit Openni2Connection(std::shared_ptr<Openni2Library> library)
      : library_(std::move(library)) {}
  Status connect(const Openni2Target& target);
  void onDeviceDisconnected(const openni::DeviceInfo* info) override;
  void onDeviceStateChanged(const openni::DeviceInfo* info, openni::DeviceState state) override;

  const std::shared_ptr<Openni2Library> library_;
  std::string uri_;
  std::string name_;
  bool is_recording_ = false;
  OniFileInfo file_;
  bool in_step_ = false;
  std::atomic<bool> gone_{false};
  std::atomic<bool> ended_{false};
};

}  // namespace bpa::camera
