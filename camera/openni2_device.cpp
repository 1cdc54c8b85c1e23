// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/openni2_device.hpp"

#include <atomic>
#include <cstring>
#include <thread>
#include <utility>

#include <openni2/OpenNI.h>

#include "camera/frame_pairs.hpp"
#include "camera/host_clock.hpp"
#include "camera/openni2_library.hpp"
#include "camera/openni2_streams.hpp"
#include "core/base/clock.hpp"

namespace bpa::camera {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr float kManualSpeed = -1;  // OpenNI2: a frame comes when somebody waits for one

Status not_there(const std::string& uri) {
  if (uri.empty()) return Status(StatusCode::unavailable, "no OpenNI2 sensor is connected");
  return Status(
      StatusCode::unavailable,
      "the OpenNI2 sensor " + uri + " is not there or cannot be opened: " + openni2_error());
}

Status failed(const std::string& what) {
  return Status(StatusCode::unavailable, what + ": " + openni2_error());
}

class Openni2Device : public CameraDevice,
                      public openni::OpenNI::DeviceDisconnectedListener,
                      public openni::OpenNI::DeviceStateChangedListener {
 public:
  Openni2Device(std::shared_ptr<Openni2Library> library, Openni2Target target,
                const CameraOptions& options, LogHook hook)
      : library_(std::move(library)),
        target_(std::move(target)),
        options_(options),
        log_(std::move(hook)) {}
  ~Openni2Device() override;

  /// To be called once, before anything else.
  Status open();

  const std::string& name() const override { return name_; }
  Result<DeviceOutput> next(milliseconds wait) override;
  std::string complaint() const override { return complaint_; }
  Status start_recording(const std::string& path) override;
  Result<RecordingSummary> stop_recording() override;

 private:
  void onDeviceDisconnected(const openni::DeviceInfo* info) override {
    if (uri_ == info->getUri()) gone_ = true;
  }
  void onDeviceStateChanged(const openni::DeviceInfo* info, openni::DeviceState state) override {
    if (uri_ == info->getUri() && state == openni::DEVICE_STATE_EOF) ended_ = true;
  }

  // Steps of open().
  Status open_device();
  Status open_depth();
  Status open_color();
  Status settle_geometry();
  Status start_streams();
  Status settle_registration();
  Result<Alignment> ask_device_to_register();
  Status settle_playback();
  Status put_in_step();
  std::vector<std::uint16_t> depth_after(int frames);

  Status read_one(milliseconds wait);
  SensorImages images_of(const openni::VideoFrameRef& depth, const openni::VideoFrameRef* color,
                         std::int64_t depth_us);
  Image depth_image(const openni::VideoFrameRef& frame) const;
  void record(const openni::VideoFrameRef& depth, const openni::VideoFrameRef* color);
  bool with_color() const { return color_.isValid(); }
  /// Before the device counts as one that delivers nothing.
  bool color_is_missing() const {
    return Clock::now() - last_color_ > milliseconds(static_cast<int>(options_.timeout_ms / 2));
  }

  const std::shared_ptr<Openni2Library> library_;
  const Openni2Target target_;
  const CameraOptions options_;
  const LogHook log_;
  OniFileInfo file_;
  std::string uri_;
  std::string name_;
  openni::Device device_;
  openni::VideoStream depth_;
  openni::VideoStream color_;
  bool depth_mirrored_ = false;
  bool color_mirrored_ = false;
  int max_depth_ = 0;
  DeviceGeometry geometry_;
  Intrinsics output_;     ///< Of the images that go out.
  bool in_step_ = false;  ///< The device delivers depth and colour in pairs.
  bool device_registers_ = false;
  bool server_registers_ = false;
  /// Depth frames with a smaller number are skipped one by one: OpenNI2's own seek crashes in the
  /// player of Debian 12 (libOniFile of 2.2.0.33).
  int first_frame_ = 0;
  std::atomic<bool> gone_{false};
  std::atomic<bool> ended_{false};

  FramePairs<openni::VideoFrameRef> pairs_{0};
  HostClock clock_;
  std::int64_t last_depth_us_ = -1;
  Clock::time_point last_color_ = Clock::now();
  std::string complaint_;
  std::optional<OniWriter> writer_;
  Status recording_status_;
};

Openni2Device::~Openni2Device() {
  openni::OpenNI::removeDeviceDisconnectedListener(this);
  openni::OpenNI::removeDeviceStateChangedListener(this);
  if (in_step_) device_.setDepthColorSyncEnabled(false);  // while its streams are still there
  if (depth_.isValid()) depth_.stop();
  if (color_.isValid()) color_.stop();
  // Some drivers (Debian's DummyDevice) go on with the frame that they are making after stop().
  if (depth_.isValid()) std::this_thread::sleep_for(milliseconds(50));
  depth_.destroy();
  color_.destroy();
  device_.close();
}

Status Openni2Device::open() {
  for (Status (Openni2Device::*step)() :
       {&Openni2Device::open_device, &Openni2Device::open_depth, &Openni2Device::open_color,
        &Openni2Device::settle_geometry, &Openni2Device::start_streams,
        &Openni2Device::settle_registration, &Openni2Device::settle_playback,
        &Openni2Device::put_in_step}) {
    if (Status status = (this->*step)(); !status.ok()) return status;
  }
  last_color_ = Clock::now();
  return {};
}

Status Openni2Device::open_device() {
  uri_ = target_.uri;
  if (target_.file) {
    auto info = inspect_oni_file(uri_);
    if (!info.ok()) return info.status();
    if (uri_.size() >= ONI_MAX_STR) {
      return invalid_argument(uri_ + " is too long a path for OpenNI2, which takes 255 characters");
    }
    file_ = *info;
  } else if (uri_.empty()) {
    openni::Array<openni::DeviceInfo> found;
    openni::OpenNI::enumerateDevices(&found);
    if (found.getSize() == 0) return not_there(uri_);
    uri_ = found[0].getUri();
  }
  openni::OpenNI::addDeviceDisconnectedListener(this);
  openni::OpenNI::addDeviceStateChangedListener(this);
  if (device_.open(uri_.c_str()) != openni::STATUS_OK) return not_there(uri_);
  name_ = target_.file ? "the recording " + uri_
                       : std::string(device_.getDeviceInfo().getName()) + " (" + uri_ + ")";
  if (!target_.file) device_.setImageRegistrationMode(openni::IMAGE_REGISTRATION_OFF);
  return {};
}

Status Openni2Device::open_depth() {
  const openni::SensorInfo* sensor = device_.getSensorInfo(openni::SENSOR_DEPTH);
  if (sensor == nullptr) return invalid_argument(name_ + " has no depth sensor");
  if (depth_.create(device_, openni::SENSOR_DEPTH) != openni::STATUS_OK) {
    return failed(name_ + " gives no depth");
  }
  if (!target_.file) {
    const Status s = choose_mode(depth_, *sensor, "capture.depth_mode", options_.depth_mode);
    if (!s.ok()) return s;
  }
  const openni::PixelFormat format = depth_.getVideoMode().getPixelFormat();
  if (!readable(format)) {
    return Status(StatusCode::unsupported, name_ + " gives depth in the format " +
                                               std::to_string(format) +
                                               "; it must be in 1 mm (100) or 0.1 mm (101)");
  }
  geometry_.depth_unit = format == openni::PIXEL_FORMAT_DEPTH_1_MM ? 1e-3 : 1e-4;
  depth_mirrored_ = still_mirrored(depth_);
  max_depth_ = depth_.getMaxPixelValue();
  return {};
}

Status Openni2Device::open_color() {
  const openni::SensorInfo* sensor = device_.getSensorInfo(openni::SENSOR_COLOR);
  if (!options_.color) return {};
  if (sensor == nullptr) {
    complaint_ = "it has no colour camera, so there is depth alone";
    return {};
  }
  if (color_.create(device_, openni::SENSOR_COLOR) != openni::STATUS_OK) {
    return failed(name_ + " gives no colour");
  }
  if (!target_.file) {
    const Status s = choose_mode(color_, *sensor, "capture.color_mode", options_.color_mode);
    if (!s.ok()) return s;
  }
  if (!readable(color_.getVideoMode().getPixelFormat())) {
    color_.destroy();
    complaint_ = "its colour is neither rgb nor grey, so there is depth alone";
    return {};
  }
  color_mirrored_ = still_mirrored(color_);
  if (!target_.file) set_exposure(color_, options_, log_);
  return {};
}

Status Openni2Device::settle_geometry() {
  if (!with_color()) {
    auto depth = intrinsics_of(depth_, options_.depth_calibration, "depth camera");
    if (!depth.ok()) return depth.status();
    output_ = *depth;
    geometry_.depth = geometry_.color = depth->camera;
    return {};
  }
  auto color = intrinsics_of(color_, options_.calibration, "colour camera");
  if (!color.ok()) return color.status();
  output_ = *color;
  geometry_.color = color->camera;
  geometry_.color_distortion = color->distortion;
  // While registration is off, and only needed if the server is to do it.
  const auto depth = intrinsics_of(depth_, options_.depth_calibration, "depth camera");
  geometry_.depth = depth.ok() ? depth->camera : color->camera;
  const double told = baseline_of(depth_);
  geometry_.baseline = told > 0 ? told : options_.baseline_mm / 1000;
  return {};
}

Status Openni2Device::start_streams() {
  if (with_color()) {
    const double period_us = 1e6 / std::max(1, depth_.getVideoMode().getFps());
    pairs_ = FramePairs<openni::VideoFrameRef>(static_cast<std::int64_t>(period_us / 2));
  }
  if (target_.file) {
    openni::PlaybackControl* playback = device_.getPlaybackControl();
    if (playback == nullptr) return failed(name_ + " cannot be played");
    playback->setRepeatEnabled(options_.loop);
    first_frame_ = options_.start_frame;
    playback->setSpeed(options_.every_frame || first_frame_ > 1
                           ? kManualSpeed
                           : static_cast<float>(options_.speed));
  }
  if (depth_.start() != openni::STATUS_OK)
    return failed(name_ + " does not start its depth stream");
  if (with_color() && color_.start() != openni::STATUS_OK) {
    return failed(name_ + " does not start its colour stream");
  }
  return {};
}

/// The depth image that comes after so many others; empty when none comes.
std::vector<std::uint16_t> Openni2Device::depth_after(int frames) {
  openni::VideoFrameRef frame;
  openni::VideoStream* streams[] = {&depth_};
  for (int i = 0; i <= frames; ++i) {
    int ready = 0;
    const int patience = static_cast<int>(options_.timeout_ms);
    if (openni::OpenNI::waitForAnyStream(streams, 1, &ready, patience) != openni::STATUS_OK ||
        depth_.readFrame(&frame) != openni::STATUS_OK) {
      return {};
    }
  }
  return depth_pixels(frame, depth_mirrored_, max_depth_);
}

/// Asks the device to register and looks whether it does; a few times while the view changes.
Result<Alignment> Openni2Device::ask_device_to_register() {
  constexpr int kTries = 3;
  const auto mode = openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
  if (!device_.isImageRegistrationModeSupported(mode)) return Alignment::not_registered;
  Alignment alignment = Alignment::cannot_tell;
  for (int i = 0; i < kTries && alignment == Alignment::cannot_tell; ++i) {
    device_.setImageRegistrationMode(openni::IMAGE_REGISTRATION_OFF);
    const std::vector<std::uint16_t> before = depth_after(i > 0 ? 2 : 0);
    if (before.empty()) return Status(StatusCode::unavailable, "delivers no depth frames");
    if (device_.setImageRegistrationMode(mode) != openni::STATUS_OK ||
        device_.getImageRegistrationMode() != mode) {
      return Alignment::not_registered;
    }
    const std::vector<std::uint16_t> after = depth_after(2);
    if (after.empty()) return Status(StatusCode::unavailable, "delivers no depth frames");
    alignment = judge_registration(before, after, geometry_);
  }
  return alignment;
}

Status Openni2Device::settle_registration() {
  const std::string& who = options_.registration;
  if (!with_color() || who == "off") return {};
  if (target_.file) {
    const bool unregistered = file_.registered == OniFileInfo::Registered::no;
    device_registers_ = !unregistered && who != "software";
    server_registers_ = !device_registers_;
    return {};
  }
  if (who != "software") {
    const auto alignment = ask_device_to_register();
    if (!alignment.ok()) {
      return Status(alignment.status().code, name_ + " " + alignment.status().message);
    }
    device_registers_ = *alignment != Alignment::not_registered;
    if (*alignment == Alignment::cannot_tell) {
      log(log_, LogLevel::info,
          "capture: nothing in view shows whether " + name_ +
              " registers depth to colour, as it says");
    }
  }
  if (device_registers_) return {};
  if (who == "device") {
    return Status(StatusCode::unsupported, name_ + " does not register depth to colour; set " +
                                               "capture.registration to auto or software");
  }
  server_registers_ = true;
  device_.setImageRegistrationMode(openni::IMAGE_REGISTRATION_OFF);
  (void)depth_after(2);  // what is on its way may still be registered
  if (who == "auto") {
    log(log_, LogLevel::info,
        "capture: " + name_ + " does not register depth to colour; the server does it");
  }
  return {};
}

Status Openni2Device::settle_playback() {
  if (!target_.file || options_.start_frame <= 1) return {};
  const OniStreamInfo* stream = file_.find(OniStreamInfo::Kind::depth);
  const int count = stream != nullptr ? static_cast<int>(stream->frames) : 0;
  if (options_.start_frame > count) {
    return invalid_argument("capture.start_frame is " + std::to_string(options_.start_frame) +
                            "; " + uri_ + " has " + std::to_string(count) + " frames");
  }
  return {};
}

/// Has the device deliver depth and colour in pairs. Last, because from then on OpenNI2 waits for
/// ever unless both streams are read. Devices that cannot are paired by time stamps, as all are.
Status Openni2Device::put_in_step() {
  if (!with_color() || target_.file) return {};
  in_step_ = device_.setDepthColorSyncEnabled(true) == openni::STATUS_OK;
  log(log_, LogLevel::debug,
      std::string("capture: depth and colour are put in step by ") +
          (in_step_ ? "the device" : "the server"));
  return {};
}

/// Waits for a frame of either stream and keeps it; `timeout` when none comes.
Status Openni2Device::read_one(milliseconds wait) {
  openni::VideoStream* streams[] = {&depth_, &color_};
  int ready = 0;
  const openni::Status waited = openni::OpenNI::waitForAnyStream(
      streams, with_color() ? 2 : 1, &ready, static_cast<int>(wait.count()));
  if (waited == openni::STATUS_TIME_OUT) return Status(StatusCode::timeout, "");
  openni::VideoFrameRef frame;
  if (waited != openni::STATUS_OK || streams[ready]->readFrame(&frame) != openni::STATUS_OK) {
    return Status(StatusCode::unavailable, "gives no frames: " + openni2_error());
  }
  if (frame.getCroppingEnabled()) {
    return Status(StatusCode::unsupported, "gives images that are cropped");
  }
  const auto stamp = static_cast<std::int64_t>(frame.getTimestamp());
  if (ready == 1) {
    last_color_ = Clock::now();
    pairs_.add_color(frame, stamp);
    return {};
  }
  if (frame.getFrameIndex() < first_frame_) return {};
  if (first_frame_ > 1 && !options_.every_frame) {
    device_.getPlaybackControl()->setSpeed(static_cast<float>(options_.speed));
  }
  first_frame_ = 0;
  if (stamp < last_depth_us_) pairs_.clear();  // a recording that begins again
  last_depth_us_ = stamp;
  pairs_.add_depth(frame, stamp);
  return {};
}

Result<DeviceOutput> Openni2Device::next(milliseconds wait) {
  DeviceOutput output;
  const auto deadline = Clock::now() + wait;
  while (Clock::now() < deadline) {
    if (gone_) return Status(StatusCode::unavailable, "was pulled out");
    const bool ended = ended_;
    const Status read = read_one(std::min(wait, milliseconds(ended ? 20 : 100)));
    if (read.code == StatusCode::timeout) {
      if (in_step_ && color_is_missing()) {
        // A device that keeps them in step gives no depth without colour.
        device_.setDepthColorSyncEnabled(false);
        in_step_ = false;
      }
      output.ended = ended;
      if (ended) return output;
      continue;
    }
    if (!read.ok()) return read;
    output.busy = first_frame_ > 1;
    if (!with_color()) {
      if (const auto depth = pairs_.take_depth()) {
        output.images = images_of(depth->first, nullptr, depth->second);
        return output;
      }
    } else if (const auto pair = pairs_.take()) {
      complaint_.clear();
      output.images = images_of(pair->depth, &pair->color, pair->depth_us);
      return output;
    } else if (color_is_missing()) {
      if (const auto depth = pairs_.take_depth()) {
        complaint_ = "depth comes without colour";
        output.images = images_of(depth->first, nullptr, depth->second);
        return output;
      }
    }
  }
  return output;
}

Image Openni2Device::depth_image(const openni::VideoFrameRef& frame) const {
  std::vector<std::uint16_t> depth = depth_pixels(frame, depth_mirrored_, max_depth_);
  if (server_registers_) depth = register_depth(depth, geometry_);
  const Camera& camera = server_registers_ ? geometry_.color : geometry_.depth;
  const bool millimetres = geometry_.depth_unit == 1e-3;
  Image image{
      millimetres ? PixelFormat::depth_mm : PixelFormat::depth_m, camera.width, camera.height, {}};
  image.bytes.resize(depth.size() * bytes_per_pixel(image.format));
  if (millimetres) {
    std::memcpy(image.bytes.data(), depth.data(), image.bytes.size());
    return image;
  }
  std::vector<float> metres(depth.size());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    metres[i] = static_cast<float>(depth[i] * geometry_.depth_unit);
  }
  std::memcpy(image.bytes.data(), metres.data(), image.bytes.size());
  return image;
}

SensorImages Openni2Device::images_of(const openni::VideoFrameRef& depth,
                                      const openni::VideoFrameRef* color, std::int64_t depth_us) {
  record(depth, color);
  SensorImages images;
  images.stamp_ns = clock_.map(depth_us, unix_time_ns());
  images.depth = depth_image(depth);
  if (color != nullptr) {
    const bool rgb = color->getVideoMode().getPixelFormat() == openni::PIXEL_FORMAT_RGB888;
    images.color = Image{rgb ? PixelFormat::rgb : PixelFormat::grey, color->getWidth(),
                         color->getHeight(), color_pixels(*color, color_mirrored_)};
  }
  images.camera = output_.camera;
  images.distortion = output_.distortion;
  return images;
}

Status Openni2Device::start_recording(const std::string& path) {
  std::vector<OniStreamFormat> formats = {recorded_format(depth_, OniStreamInfo::Kind::depth)};
  if (with_color()) formats.push_back(recorded_format(color_, OniStreamInfo::Kind::color));
  auto writer = OniWriter::create(path, formats, device_registers_);
  if (!writer.ok()) return writer.status();
  writer_.emplace(std::move(writer).value());
  recording_status_ = {};
  return {};
}

void Openni2Device::record(const openni::VideoFrameRef& depth, const openni::VideoFrameRef* color) {
  if (!writer_ || !recording_status_.ok()) return;
  recording_status_ = record_frame(*writer_, 0, depth);
  if (recording_status_.ok() && color != nullptr) {
    recording_status_ = record_frame(*writer_, 1, *color);
  }
  if (!recording_status_.ok()) {
    log(log_, LogLevel::error, "capture: " + recording_status_.message);
  }
}

Result<RecordingSummary> Openni2Device::stop_recording() {
  if (!writer_) return CameraDevice::stop_recording();
  OniWriter writer = *std::exchange(writer_, std::nullopt);
  if (!recording_status_.ok()) return recording_status_;
  if (Status status = writer.finish(); !status.ok()) return status;
  return RecordingSummary{writer.path(), writer.frames(0), writer.bytes()};
}

}  // namespace

OpenCamera openni2_camera(const Openni2Target& target, const CameraOptions& options, LogHook hook) {
  // Drivers stay loaded between attempts, so that they notice a device that comes back. Loading
  // them again is no way: OpenNI2 holds a lock while it ends a driver, which deadlocks with one
  // that announces a device just then.
  auto library = std::make_shared<std::shared_ptr<Openni2Library>>();
  return [target, options, hook = std::move(hook),
          library]() -> Result<std::unique_ptr<CameraDevice>> {
    if (!*library) {
      auto loaded = Openni2Library::load();
      if (!loaded.ok()) return loaded.status();
      *library = *loaded;
    }
    auto device = std::make_unique<Openni2Device>(*library, target, options, hook);
    if (Status status = device->open(); !status.ok()) return status;
    return std::unique_ptr<CameraDevice>(std::move(device));
  };
}

}  // namespace bpa::camera
