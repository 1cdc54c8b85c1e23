// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/openni2_sim/sim_stream.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <openni2/PS1080.h>

namespace bpa::sim_driver {
namespace {

constexpr int kMaxDepthMm = 6500;
/// Per cent of blue under a warm lamp, as seen without white balance.
constexpr int kLampBlue = 70;
/// Each scene is shown for half a second.
constexpr std::uint64_t kTicksPerScene = 15;

/// Hands out one value, as OpenNI2 asks for it.
template <class T>
OniStatus give(const T& value, void* data, int* size) {
  if (*size < static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof(T));
  *size = sizeof(T);
  return ONI_STATUS_OK;
}

template <class T>
OniStatus take(const void* data, int size, T& value) {
  if (size != static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(&value, data, sizeof(T));
  return ONI_STATUS_OK;
}

bool equal(const OniVideoMode& a, const OniVideoMode& b) {
  return a.pixelFormat == b.pixelFormat && a.resolutionX == b.resolutionX &&
         a.resolutionY == b.resolutionY && a.fps == b.fps;
}

int pixel_bytes(const OniVideoMode& mode) {
  return mode.pixelFormat == ONI_PIXEL_FORMAT_RGB888 ? 3 : 2;
}

}  // namespace

std::vector<OniVideoMode> modes_of(OniSensorType sensor, const Camera& camera, bool fine_depth) {
  std::vector<OniVideoMode> modes;
  for (const int divisor : {1, 2}) {
    for (const int fps : {30, 15}) {
      OniVideoMode mode{};
      mode.resolutionX = camera.width / divisor;
      mode.resolutionY = camera.height / divisor;
      mode.fps = fps;
      mode.pixelFormat =
          sensor == ONI_SENSOR_DEPTH ? ONI_PIXEL_FORMAT_DEPTH_1_MM : ONI_PIXEL_FORMAT_RGB888;
      if (sensor != ONI_SENSOR_DEPTH || !fine_depth) modes.push_back(mode);
      if (sensor != ONI_SENSOR_DEPTH) continue;
      mode.pixelFormat = ONI_PIXEL_FORMAT_DEPTH_100_UM;
      modes.push_back(mode);
    }
  }
  return modes;
}

SimStream::SimStream(OniSensorType sensor, const SimFrames& frames, const SimConfig& config,
                     const std::atomic<bool>& registering)
    : sensor_(sensor),
      frames_(frames),
      config_(config),
      registering_(registering),
      mode_(modes_of(sensor, sensor == ONI_SENSOR_DEPTH ? frames.depth : frames.color,
                     config.fine_depth)
                .front()) {}

SimStream::~SimStream() { stop(); }

OniStatus SimStream::start() {
  config_.pass();
  const std::lock_guard<std::mutex> lock(mutex_);
  running_ = true;
  return ONI_STATUS_OK;
}

void SimStream::stop() {
  config_.pass();
  const std::lock_guard<std::mutex> lock(mutex_);
  running_ = false;
}

OniStatus SimStream::set_mode(const OniVideoMode& mode) {
  const Camera& camera = sensor_ == ONI_SENSOR_DEPTH ? frames_.depth : frames_.color;
  for (const OniVideoMode& known : modes_of(sensor_, camera, config_.fine_depth)) {
    if (!equal(known, mode)) continue;
    mode_ = mode;
    return ONI_STATUS_OK;
  }
  return ONI_STATUS_NOT_SUPPORTED;
}

int* SimStream::setting(int id) {
  if (id == ONI_STREAM_PROPERTY_MIRRORING) return &mirrored_;
  if (sensor_ != ONI_SENSOR_COLOR) return nullptr;
  switch (id) {
    case ONI_STREAM_PROPERTY_AUTO_EXPOSURE:
      return &auto_exposure_;
    case ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE:
      return &auto_white_balance_;
    case ONI_STREAM_PROPERTY_EXPOSURE:
      return &exposure_;
    case ONI_STREAM_PROPERTY_GAIN:
      return &gain_;
    default:
      return nullptr;
  }
}

OniStatus SimStream::setProperty(int id, const void* data, int size) {
  config_.pass();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (int* value = setting(id)) return take(data, size, *value);
  if (id != ONI_STREAM_PROPERTY_VIDEO_MODE) return ONI_STATUS_NOT_SUPPORTED;
  OniVideoMode mode{};
  const OniStatus status = take(data, size, mode);
  return status == ONI_STATUS_OK ? set_mode(mode) : status;
}

OniStatus SimStream::getProperty(int id, void* data, int* size) {
  config_.pass();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (const int* value = setting(id)) return give(*value, data, size);
  const bool depth = sensor_ == ONI_SENSOR_DEPTH;
  const Camera& camera = !depth || shows_registered() ? frames_.color : frames_.depth;
  switch (id) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      return give(mode_, data, size);
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
      return give(static_cast<float>(2 * std::atan(camera.width / (2 * camera.fx))), data, size);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
      return give(static_cast<float>(2 * std::atan(camera.height / (2 * camera.fy))), data, size);
    case ONI_STREAM_PROPERTY_STRIDE:
      return give(mode_.resolutionX * pixel_bytes(mode_), data, size);
    case ONI_STREAM_PROPERTY_CROPPING:  // never; but players show no stream that does not say so
      return give(OniCropping{}, data, size);
    default:
      break;
  }
  if (!depth) return ONI_STATUS_NOT_SUPPORTED;
  const int units = mode_.pixelFormat == ONI_PIXEL_FORMAT_DEPTH_1_MM ? 1 : 10;
  if (id == ONI_STREAM_PROPERTY_MAX_VALUE) return give(kMaxDepthMm * units, data, size);
  if (id == ONI_STREAM_PROPERTY_MIN_VALUE) return give(0, data, size);
  if (id == XN_STREAM_PROPERTY_DCMOS_RCMOS_DISTANCE) return give(kBaseline * 100, data, size);
  return ONI_STATUS_NOT_SUPPORTED;
}

OniBool SimStream::isPropertySupported(int id) {
  char value[64];
  int size = sizeof value;
  return getProperty(id, value, &size) == ONI_STATUS_OK ? TRUE : FALSE;
}

void SimStream::notifyAllProperties() {
  // What OpenNI2's recorder keeps beside the frames.
  if (sensor_ != ONI_SENSOR_DEPTH) return;
  const double centimetres = kBaseline * 100;
  raisePropertyChanged(XN_STREAM_PROPERTY_DCMOS_RCMOS_DISTANCE, &centimetres, sizeof centimetres);
}

bool SimStream::shows_registered() const {
  return registering_ && config_.registration == Registration::device;
}

void SimStream::fill_depth(const SimFrame& scene, OniFrame& frame) const {
  const bool registered = shows_registered();
  const Camera& camera = registered ? frames_.color : frames_.depth;
  const std::vector<std::uint16_t>& from = registered ? scene.registered : scene.unregistered;
  auto* out = static_cast<std::uint16_t*>(frame.data);
  const int step = camera.width / mode_.resolutionX;
  const bool millimetres = mode_.pixelFormat == ONI_PIXEL_FORMAT_DEPTH_1_MM;
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const int column = mirrored_ != FALSE ? frame.width - 1 - u : u;
      const std::uint16_t z =
          from[static_cast<std::size_t>(v * step * camera.width + column * step)];
      *out++ = millimetres ? static_cast<std::uint16_t>((z + 5) / 10) : z;
    }
  }
}

void SimStream::fill_color(const SimFrame& scene, OniFrame& frame) const {
  const Camera& camera = frames_.color;
  auto* out = static_cast<std::uint8_t*>(frame.data);
  const int step = camera.width / mode_.resolutionX;
  const int brightness = auto_exposure_ != FALSE ? 10000 : exposure_ * gain_;
  const int blue = auto_white_balance_ != FALSE ? brightness : brightness * kLampBlue / 100;
  const int gains[3] = {brightness, brightness, blue};
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const int column = mirrored_ != FALSE ? frame.width - 1 - u : u;
      const auto* pixel =
          scene.rgb.data() + 3 * static_cast<std::size_t>(v * step * camera.width + column * step);
      for (int c = 0; c < 3; ++c) {
        *out++ = static_cast<std::uint8_t>(std::min(255, pixel[c] * gains[c] / 10000));
      }
    }
  }
}

void SimStream::fill(const SimFrame& scene, OniFrame& frame) const {
  frame.videoMode = mode_;
  frame.sensorType = sensor_;
  frame.width = mode_.resolutionX;
  frame.height = mode_.resolutionY;
  frame.stride = mode_.resolutionX * pixel_bytes(mode_);
  frame.dataSize = frame.stride * frame.height;
  frame.cropOriginX = frame.cropOriginY = 0;
  frame.croppingEnabled = FALSE;
  if (sensor_ == ONI_SENSOR_DEPTH) {
    fill_depth(scene, frame);
  } else {
    fill_color(scene, frame);
  }
}

void SimStream::show(std::uint64_t tick, std::uint64_t timestamp_us) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto every = static_cast<std::uint64_t>(30 / mode_.fps);
  if (!running_ || tick % every != 0) return;
  if (sensor_ == ONI_SENSOR_COLOR && !config_.deliver_color) return;
  OniFrame* frame = getServices().acquireFrame();
  if (frame == nullptr) return;
  fill(frames_.frames[tick / kTicksPerScene % frames_.frames.size()], *frame);
  frame->frameIndex = static_cast<int>(tick / every) + 1;
  frame->timestamp = timestamp_us;
  raiseNewFrame(frame);
  getServices().releaseFrame(frame);
}

}  // namespace bpa::sim_driver
