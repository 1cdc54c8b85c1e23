// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <openni2/OpenNI.h>

#include "camera/camera_options.hpp"
#include "camera/oni_file.hpp"
#include "camera/registration.hpp"
#include "core/base/log.hpp"
#include "core/base/status.hpp"

// Single streams of OpenNI2: modes, properties, intrinsics, pixels. Only files named openni2*
// include this.

namespace bpa::camera {

/// Sets the mode that the setting `field` asks for, in the best pixel format we can read; fails and
/// lists the modes when the device has none such.
Status choose_mode(openni::VideoStream& stream, const openni::SensorInfo& sensor,
                   const std::string& field, const std::string& wanted);
/// Whether pixels of this format can be read: depth in 1 or 0.1 mm, colour as rgb or grey.
bool readable(openni::PixelFormat format);

/// How the frames of a stream that was set up are to be read.
struct StreamFormat {
  bool mirrored = false;  ///< Rows come in reverse although mirroring was switched off.
  int max_value = 0;      ///< Larger depths are none, in the stream's unit; 0: all are good.
};

/// Switches mirroring off; true when the stream is mirrored all the same.
bool still_mirrored(openni::VideoStream& stream);
/// Exposure, gain and white balance; says what the device cannot do.
void set_exposure(openni::VideoStream& color, const CameraOptions& options, const LogHook& log);

/// From a calibration file, or the field of view if `path` is empty. `what` names the stream.
struct Intrinsics {
  Camera camera;
  std::vector<double> distortion;
};
Result<Intrinsics> intrinsics_of(openni::VideoStream& stream, const std::string& path,
                                 const std::string& what);
/// Metres from the depth to the colour camera, where the device says; else 0.
double baseline_of(openni::VideoStream& depth);

/// Row-major depth without padding, in the stream's unit; 0 where there is none.
std::vector<std::uint16_t> depth_pixels(const openni::VideoFrameRef& frame,
                                        const StreamFormat& format);
/// Row-major bytes of a frame of any readable format without padding, mirrored if asked.
std::vector<std::uint8_t> pixel_bytes_of(const openni::VideoFrameRef& frame, bool mirror);

/// The stream's format for a recording.
OniStreamFormat recorded_format(openni::VideoStream& stream, OniStreamInfo::Kind kind);
/// Adds the frame as it came from the driver.
Status record_frame(OniWriter& writer, std::size_t index, const openni::VideoFrameRef& frame);

}  // namespace bpa::camera
