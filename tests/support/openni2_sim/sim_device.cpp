// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <openni2/Driver/OniDriverAPI.h>
#include <openni2/PS1080.h>

#include "tests/support/openni2_sim/sim_scenes.hpp"

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
void visit_pixels(const OniVideoMode& mode, bool mirrored, int width, auto visit) {
  const int step = width / mode.resolutionX;
  for (int v = 0; v < mode.resolutionY; ++v) {
    for (int u = 0; u < mode.resolutionX; ++u) {
      const int column = mirrored ? mode.resolutionX - 1 - u : u;
      visit(static_cast<std::size_t>(v * step * width + column * step));
    }
  }
}

/// Hands out the value of a property, as OpenNI2 asks for it.
OniStatus give(const auto& value, void* data, int* size) {
  if (*size < static_cast<int>(sizeof value)) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof value);
  *size = sizeof value;
  return ONI_STATUS_OK;
}

/// Takes the value of a property, as OpenNI2 sets it.
OniStatus take(const void* data, int size, auto& value) {
  if (size != static_cast<int>(sizeof value)) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(&value, data, sizeof value);
  return ONI_STATUS_OK;
}

/// The modes of one sensor: the size of the frames and half of it, at 30 and 15 Hz; `fine_depth`
/// leaves out those with depth in millimetres.
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

/// The depth or the colour stream. OpenNI2's threads set properties and start and stop it while the
/// device's thread shows frames.
class SimStream : public oni::driver::StreamBase {
 public:
  /// `registering` is the device's switch; the device holds `showing` while it calls show().
  SimStream(bool depth, const std::vector<OniVideoMode>& modes, const SimFrames& frames,
            const SimConfig& config, const std::atomic<bool>& registering, std::mutex& showing)
      : depth_(depth),
        modes_(modes),
        frames_(frames),
        config_(config),
        registering_(registering),
        showing_(showing),
        mode_(modes.front()) {
    if (depth_) return;
    settings_.insert({{ONI_STREAM_PROPERTY_AUTO_EXPOSURE, TRUE},
                      {ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE, TRUE},
                      {ONI_STREAM_PROPERTY_EXPOSURE, 100},  // per cent of what was rendered
                      {ONI_STREAM_PROPERTY_GAIN, 100}});
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    config_.pass();
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto setting = settings_.find(id);
    if (setting != settings_.end()) return take(data, size, setting->second);
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

  OniStatus getProperty(int id, void* data, int* size) override {
    config_.pass();
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto setting = settings_.find(id);
    if (setting != settings_.end()) return give(setting->second, data, size);
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

  OniBool isPropertySupported(int id) override {
    char value[64];
    int size = sizeof value;
    return getProperty(id, value, &size) == ONI_STATUS_OK ? TRUE : FALSE;
  }

  void notifyAllProperties() override {
    // What OpenNI2's recorder keeps beside the frames.
    if (!depth_) return;
    const double centimetres = kBaseline * 100;
    raisePropertyChanged(XN_STREAM_PROPERTY_DCMOS_RCMOS_DISTANCE, &centimetres, sizeof centimetres);
  }

  OniStatus start() override {
    set_running(true);
    return ONI_STATUS_OK;
  }
  /// No frame comes after this. Here and not in destroyStream(), which OpenNI2 calls with the lock
  /// that a frame on its way waits for.
  void stop() override {
    set_running(false);
    const std::lock_guard<std::mutex> shown(showing_);
  }

  /// Delivers the tick's frame if the stream runs and its rate wants it. Ticks come at 30 Hz.
  void show(std::uint64_t tick, std::uint64_t timestamp_us) {
    if (!wants(tick)) return;
    // Not locked while OpenNI2 is called, which may be waiting for this lock with one of its own.
    OniFrame* frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      fill(frames_.frames[tick / kTicksPerScene % frames_.frames.size()], *frame);
      frame->frameIndex = static_cast<int>(tick / ticks_per_frame()) + 1;
    }
    frame->timestamp = timestamp_us;
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }

 private:
  void set_running(bool running) {
    config_.pass();
    const std::lock_guard<std::mutex> lock(mutex_);
    running_ = running;
  }

  std::uint64_t ticks_per_frame() const { return static_cast<std::uint64_t>(30 / mode_.fps); }
  bool wants(std::uint64_t tick) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return running_ && tick % ticks_per_frame() == 0 && (depth_ || config_.deliver_color);
  }

  /// Whether depth is shown as its own camera sees it, not as the colour camera would.
  bool in_own_view() const { return depth_ && !(registering_ && config_.registers); }

  void fill(const SimFrame& scene, OniFrame& frame) const {
    frame.videoMode = mode_;
    frame.sensorType = depth_ ? ONI_SENSOR_DEPTH : ONI_SENSOR_COLOR;
    frame.width = mode_.resolutionX;
    frame.height = mode_.resolutionY;
    frame.stride = stride_of(mode_);
    frame.dataSize = frame.stride * frame.height;
    frame.cropOriginX = frame.cropOriginY = 0;
    frame.croppingEnabled = FALSE;
    const bool mirrored = settings_.at(ONI_STREAM_PROPERTY_MIRRORING) != FALSE;
    if (depth_) {
      const bool own = in_own_view();
      const std::vector<std::uint16_t>& units = own ? scene.unregistered : scene.registered;
      const bool millimetres = mode_.pixelFormat == ONI_PIXEL_FORMAT_DEPTH_1_MM;
      auto* out = static_cast<std::uint16_t*>(frame.data);
      visit_pixels(mode_, mirrored, own ? frames_.depth.width : frames_.color.width,
                   [&](std::size_t i) {
                     const int z = millimetres ? (units[i] + 5) / 10 : units[i];
                     *out++ = static_cast<std::uint16_t>(z);
                   });
      return;
    }
    const bool auto_exposure = settings_.at(ONI_STREAM_PROPERTY_AUTO_EXPOSURE) != FALSE;
    const bool auto_white = settings_.at(ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE) != FALSE;
    const int set =
        settings_.at(ONI_STREAM_PROPERTY_EXPOSURE) * settings_.at(ONI_STREAM_PROPERTY_GAIN);
    const int brightness = auto_exposure ? 10000 : set;
    const int blue = auto_white ? brightness : brightness * kLampBlue / 100;
    const int gains[3] = {brightness, brightness, blue};
    auto* out = static_cast<std::uint8_t*>(frame.data);
    visit_pixels(mode_, mirrored, frames_.color.width, [&](std::size_t i) {
      for (std::size_t c = 0; c < 3; ++c) {
        *out++ = static_cast<std::uint8_t>(std::min(255, scene.rgb[3 * i + c] * gains[c] / 10000));
      }
    });
  }

  const bool depth_;
  const std::vector<OniVideoMode>& modes_;
  const SimFrames& frames_;
  const SimConfig& config_;
  const std::atomic<bool>& registering_;
  std::mutex& showing_;
  std::mutex mutex_;  ///< Guards what follows.
  OniVideoMode mode_;
  /// The properties that can be set freely; mirrored, as real devices start.
  std::map<int, int> settings_ = {{ONI_STREAM_PROPERTY_MIRRORING, TRUE}};
  bool running_ = false;
};

/// The opened device: two streams and the thread that shows them the frames at 30 Hz.
class SimDevice : public oni::driver::DeviceBase {
 public:
  SimDevice(SimFrames frames, const SimConfig& config)
      : frames_(std::move(frames)),
        config_(config),
        depth_modes_(modes_of(ONI_SENSOR_DEPTH, frames_.depth, config.fine_depth)),
        color_modes_(modes_of(ONI_SENSOR_COLOR, frames_.color, config.fine_depth)),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    config_.pass();
    *sensors = sensors_;
    *count = config_.color_sensor ? 2 : 1;
    return ONI_STATUS_OK;
  }

  oni::driver::StreamBase* createStream(OniSensorType sensor) override {
    config_.pass();
    const bool depth = sensor == ONI_SENSOR_DEPTH;
    if (!depth && !(sensor == ONI_SENSOR_COLOR && config_.color_sensor)) return nullptr;
    const auto stream = std::make_shared<SimStream>(depth, depth ? depth_modes_ : color_modes_,
                                                    frames_, config_, registering_, showing_);
    const std::lock_guard<std::mutex> lock(mutex_);
    streams_.push_back(stream);
    return stream.get();
  }

  void destroyStream(oni::driver::StreamBase* stream) override {
    config_.pass();
    const std::lock_guard<std::mutex> lock(mutex_);
    std::erase_if(streams_, [stream](const auto& one) { return one.get() == stream; });
  }

  OniStatus setProperty(int id, const void* data, int size) override {
    config_.pass();
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_SUPPORTED;
    OniImageRegistrationMode mode{};
    const OniStatus status = take(data, size, mode);
    if (status != ONI_STATUS_OK) return status;
    if (isImageRegistrationModeSupported(mode) == FALSE) return ONI_STATUS_NOT_SUPPORTED;
    registering_ = mode == ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR;
    return ONI_STATUS_OK;
  }

  OniStatus getProperty(int id, void* data, int* size) override {
    config_.pass();
    switch (id) {
      case ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION:
        return give(
            registering_ ? ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR : ONI_IMAGE_REGISTRATION_OFF, data,
            size);
      case ONI_DEVICE_PROPERTY_DRIVER_VERSION:
        return give(OniVersion{1, 0, 0, 0}, data, size);
      default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
  }

  OniBool isPropertySupported(int id) override {
    return id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || id == ONI_DEVICE_PROPERTY_DRIVER_VERSION;
  }

  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
    config_.pass();
    return mode == ONI_IMAGE_REGISTRATION_OFF || config_.can_register;
  }

  OniStatus tryManualTrigger() override {
    config_.pass();
    return ONI_STATUS_OK;
  }

 private:
  void run(const std::stop_token& stop) {
    const auto start = std::chrono::steady_clock::now();
    for (std::uint64_t tick = 0; !stop.stop_requested(); ++tick) {
      const auto since_start = std::chrono::microseconds(tick * 1'000'000 / 30);
      std::this_thread::sleep_until(start + since_start);
      if (!config_.deliver || config_.wedged || !config_.plugged) continue;
      const std::lock_guard<std::mutex> shown(showing_);
      // Depth first, as most devices do; the device's clock started before.
      const auto stamp = static_cast<std::uint64_t>(since_start.count()) + 5'000'000;
      for (const auto& stream : streams()) stream->show(tick, stamp);
    }
  }

  std::vector<std::shared_ptr<SimStream>> streams() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return streams_;
  }

  const SimFrames frames_;
  const SimConfig& config_;
  std::vector<OniVideoMode> depth_modes_;
  std::vector<OniVideoMode> color_modes_;
  OniSensorInfo sensors_[2] = {
      {ONI_SENSOR_DEPTH, static_cast<int>(depth_modes_.size()), depth_modes_.data()},
      {ONI_SENSOR_COLOR, static_cast<int>(color_modes_.size()), color_modes_.data()}};
  std::atomic<bool> registering_{false};
  std::mutex showing_;                               ///< Held while frames are shown.
  std::mutex mutex_;                                 ///< Guards the list.
  std::vector<std::shared_ptr<SimStream>> streams_;  ///< Also of the thread while it shows them.
  std::jthread thread_;                              ///< Last: runs while all else is there.
};

}  // namespace

oni::driver::DeviceBase* new_sim_device(SimFrames frames, const SimConfig& config) {
  return new SimDevice(std::move(frames), config);
}

}  // namespace bpa::sim_driver
