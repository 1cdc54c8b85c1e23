// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <openni2/OpenNI.h>

#include "camera/camera_options.hpp"
#include "camera/oni_file.hpp"
#include "camera/registration.hpp"
#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "core/io/camera_file.hpp"

// OpenNI2: the library, its streams (modes, properties, intrinsics, pixels) and an open device.
// Only files named openni2* include this.

namespace bpa::camera {

/// OpenNI2 with its drivers, loaded while this lives. Fails when no driver can be loaded.
Result<std::shared_ptr<void>> load_openni2();
/// What OpenNI2 says about its last failure, in one line.
std::string openni2_error();

/// Whether pixels of this format can be read: depth in 1 or 0.1 mm, colour as rgb or grey.
bool readable(openni::PixelFormat format);
/// Sets the mode that the setting `field` asks for, in the best pixel format we can read; fails and
/// lists the modes when the device has none such.
Status choose_mode(openni::VideoStream& stream, const std::string& field,
                   const std::string& wanted);
/// Switches mirroring off; true when the stream is mirrored all the same.
bool still_mirrored(openni::VideoStream& stream);
/// Exposure, gain and white balance; says what the device cannot do.
void set_exposure(openni::VideoStream& color, const CameraOptions& options, const LogHook& log);

/// From a calibration file, or the field of view if `path` is empty. `what` names the stream.
Result<io::CameraFile> intrinsics_of(openni::VideoStream& stream, const std::string& path,
                                     const std::string& what);
/// Metres from the depth to the colour camera, where the device says; else 0.
double baseline_of(openni::VideoStream& depth);

/// Row-major depth without padding, in the stream's unit; 0 where there is none or more than
/// `max_value` (0: all are good). Rows are reversed if `mirror`.
std::vector<std::uint16_t> depth_pixels(const openni::VideoFrameRef& frame, bool mirror,
                                        int max_value);
/// Row-major bytes of a frame of any readable format without padding, mirrored if asked.
std::vector<std::uint8_t> pixel_bytes_of(const openni::VideoFrameRef& frame, bool mirror);

/// The stream's format for a recording.
OniStreamFormat recorded_format(openni::VideoStream& stream, OniStreamInfo::Kind kind);

/// Who registers depth to colour.
enum class Registrar { none, device, server };

/// An open device of OpenNI2, its streams and the geometry of its images. Closes them in the order
/// that drivers need.
class Openni2Connection : private openni::OpenNI::DeviceDisconnectedListener,
                          private openni::OpenNI::DeviceStateChangedListener {
 public:
  /// Opens a device and starts its streams: modes, no mirroring, exposure, the cameras' geometry,
  /// registration of depth to colour, and last depth and colour in step. `uri`: see openni2_camera.
  /// `unavailable`: no such device, or it fails. `invalid_argument`: a setting does not fit it.
  /// `unsupported`: it cannot do what is asked. A recording also: `not_found`, `corrupt`
  /// (inspect_oni_file).
  static Result<std::unique_ptr<Openni2Connection>> open(std::shared_ptr<void> library,
                                                         const std::string& uri,
                                                         const CameraOptions& options, LogHook log);
  ~Openni2Connection() override;

  bool with_color() const { return color.isValid(); }
  /// Has the device deliver depth and colour in pairs, or each by itself; false when it cannot. In
  /// pairs, OpenNI2 blocks unless both streams are read.
  bool set_in_step(bool wanted);

  std::string name;                 ///< For people: the device's, or the recording's path.
  std::optional<OniFileInfo> file;  ///< What is in the recording; nothing for a sensor.
  openni::Device device;
  openni::VideoStream depth;
  openni::VideoStream color;    ///< Not valid without colour.
  bool depth_mirrored = false;  ///< Rows come in reverse although mirroring was switched off.
  bool color_mirrored = false;
  int max_depth = 0;        ///< Larger depths are none, in the stream's unit; 0: all are good.
  DeviceGeometry geometry;  ///< Without registration. The images that go out are its `color`.
  Registrar registrar = Registrar::none;
  bool in_step = false;   ///< Whether the device delivers depth and colour in pairs.
  std::string complaint;  ///< Why there is no colour although it was asked for; empty: nothing.
  std::atomic<bool> gone{false};   ///< Whether the sensor was pulled out.
  std::atomic<bool> ended{false};  ///< Whether the recording is over; frames may still wait.

 private:
  Openni2Connection(std::shared_ptr<void> library, const std::string& uri,
                    const CameraOptions& options, LogHook log)
      : library_(std::move(library)), uri_(uri), options_(options), log_(std::move(log)) {}
  Status bring_up();
  Status connect();
  Status open_depth();
  Status open_color();
  Status measure_cameras();
  Status start_playback();
  std::vector<std::uint16_t> depth_after(int frames);
  Result<Alignment> ask_device_to_register();
  Status choose_registrar();
  /// `what` follows the device's name.
  Status failed(const std::string& what) const;
  void onDeviceDisconnected(const openni::DeviceInfo* info) override {
    if (uri_ == info->getUri()) gone = true;
  }
  void onDeviceStateChanged(const openni::DeviceInfo* info, openni::DeviceState state) override {
    if (uri_ == info->getUri() && state == openni::DEVICE_STATE_EOF) ended = true;
  }

  const std::shared_ptr<void> library_;
  std::string uri_;
  const CameraOptions options_;
  const LogHook log_;
};

}  // namespace bpa::camera
