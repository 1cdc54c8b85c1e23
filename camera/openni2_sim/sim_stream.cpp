// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/openni2_sim/sim_stream.hpp"

#include <algorithm>
#include <cmath>

#include <openni2/PS1080.h>

namespace bpa::sim_driver {
namespace {

constexpr int kMaxDepthMm = 6500;
/// Per cent of blue under a warm lamp, as seen without white balance.
constexpr int kLampBlue = 70;
/// Each scene is shown for half a second.
constexpr std::uint64_t kTicksPerScene = 15;

int stride_of(const OniVideoMode& mode) {
  return mode.resolutionX * (mode.pixelFormat == ONI_PIXEL_FORMAT_RGB888 ? 3 : 2);
}

/// Calls visit(index in the scene) for each pixel of a frame of a scene this wide.
template <class Visit>
void visit_pixels(const OniVideoMode& mode, bool mirrored, int width, Visit visit) {
  const int step = width / mode.resolutionX;
  for (int v = 0; v < mode.resolutionY; ++v) {
    for (int u = 0; u < mode.resolutionX; ++u) {
      const int column = mirrored ? mode.resolutionX - 1 - u : u;
      visit(static_cast<std::size_t>(v * step * width + column * step));
    }
  }
}

}  // namespace

std::vector<OniVideoMode> modes_of(OniSensorType sensor, const Camera& camera, bool fine_depth) {
  std::vector<OniPixelFormat> formats = {ONI_PIXEL_FORMAT_RGB888};
  if (sensor == ONI_SENSOR_DEPTH) {
    formats = {ONI_PIXEL_FORMAT_DEPTH_1_MM, ONI_PIXEL_FORMAT_DEPTH_100_UM};
    if (fine_depth) formats.erase(formats.begin());
  }
  std::vector<OniVideoMode> modes;
  for (const int divisor : {1, 2}) {
    for (const int fps : {30, 15}) {
      for (const OniPixelFormat format : formats) {
        modes.push_back({format, camera.width / divisor, camera.height / divisor, fps});
      }
    }
  }
  return modes;
}

SimStream::SimStream(OniSensorType sensor, const std::vector<OniVideoMode>& modes,
                     const SimFrames& frames, const SimConfig& config,
                     const std::atomic<bool>& registering)
    : depth_(sensor == ONI_SENSOR_DEPTH),
      modes_(modes),
      frames_(frames),
      config_(config),
      registering_(registering),
      mode_(modes.front()) {}

void SimStream::set_running(bool running) {
  config_.pass();
  const std::lock_guard<std::mutex> lock(mutex_);
  running_ = running;
}

int* SimStream::setting(int id) {
  if (id == ONI_STREAM_PROPERTY_MIRRORING) return &mirrored_;
  if (depth_) return nullptr;
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
  OniVideoMode mode{};
  if (id != ONI_STREAM_PROPERTY_VIDEO_MODE) return ONI_STATUS_NOT_SUPPORTED;
  if (take(data, size, mode) != ONI_STATUS_OK) return ONI_STATUS_BAD_PARAMETER;
  const bool known = std::any_of(modes_.begin(), modes_.end(), [&](const OniVideoMode& m) {
    return std::memcmp(&m, &mode, sizeof m) == 0;
  });
  if (!known) return ONI_STATUS_NOT_SUPPORTED;
  mode_ = mode;
  return ONI_STATUS_OK;
}

OniStatus SimStream::getProperty(int id, void* data, int* size) {
  config_.pass();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (const int* value = setting(id)) return give(*value, data, size);
  const Camera& c = in_own_view() ? frames_.depth : frames_.color;
  switch (id) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      return give(mode_, data, size);
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
      return give(static_cast<float>(2 * std::atan(c.width / (2 * c.fx))), data, size);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
      return give(static_cast<float>(2 * std::atan(c.height / (2 * c.fy))), data, size);
    case ONI_STREAM_PROPERTY_STRIDE:
      return give(stride_of(mode_), data, size);
    case ONI_STREAM_PROPERTY_CROPPING:  // never; but players show no stream that does not say so
      return give(OniCropping{}, data, size);
    default:
      break;
  }
  if (!depth_) return ONI_STATUS_NOT_SUPPORTED;
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
  if (!depth_) return;
  const double centimetres = kBaseline * 100;
  raisePropertyChanged(XN_STREAM_PROPERTY_DCMOS_RCMOS_DISTANCE, &centimetres, sizeof centimetres);
}

void SimStream::fill(const SimFrame& scene, OniFrame& frame) const {
  frame.videoMode = mode_;
  frame.sensorType = depth_ ? ONI_SENSOR_DEPTH : ONI_SENSOR_COLOR;
  frame.width = mode_.resolutionX;
  frame.height = mode_.resolutionY;
  frame.stride = stride_of(mode_);
  frame.dataSize = frame.stride * frame.height;
  frame.cropOriginX = frame.cropOriginY = 0;
  frame.croppingEnabled = FALSE;
  if (depth_) {
    const bool own = in_own_view();
    const std::vector<std::uint16_t>& units = own ? scene.unregistered : scene.registered;
    const bool millimetres = mode_.pixelFormat == ONI_PIXEL_FORMAT_DEPTH_1_MM;
    auto* out = static_cast<std::uint16_t*>(frame.data);
    visit_pixels(mode_, mirrored_ != FALSE, own ? frames_.depth.width : frames_.color.width,
                 [&](std::size_t i) {
                   const int z = millimetres ? (units[i] + 5) / 10 : units[i];
                   *out++ = static_cast<std::uint16_t>(z);
                 });
    return;
  }
  const int brightness = auto_exposure_ != FALSE ? 10000 : exposure_ * gain_;
  const int blue = auto_white_balance_ != FALSE ? brightness : brightness * kLampBlue / 100;
  const int gains[3] = {brightness, brightness, blue};
  auto* out = static_cast<std::uint8_t*>(frame.data);
  visit_pixels(mode_, mirrored_ != FALSE, frames_.color.width, [&](std::size_t i) {
    for (std::size_t c = 0; c < 3; ++c) {
      *out++ = static_cast<std::uint8_t>(std::min(255, scene.rgb[3 * i + c] * gains[c] / 10000));
    }
  });
}

void SimStream::show(std::uint64_t tick, std::uint64_t timestamp_us) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto every = static_cast<std::uint64_t>(30 / mode_.fps);
  if (!running_ || tick % every != 0) return;
  if (!depth_ && !config_.deliver_color) return;
  OniFrame* frame = getServices().acquireFrame();
  if (frame == nullptr) return;
  fill(frames_.frames[tick / kTicksPerScene % frames_.frames.size()], *frame);
  frame->frameIndex = static_cast<int>(tick / every) + 1;
  frame->timestamp = timestamp_us;
  raiseNewFrame(frame);
  getServices().releaseFrame(frame);
}

}  // namespace bpa::sim_driver
