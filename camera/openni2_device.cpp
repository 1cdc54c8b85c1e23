// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/openni2_device.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "camera/frame_pairs.hpp"
#include "camera/host_clock.hpp"
#include "camera/openni2_bring_up.hpp"
#include "core/base/clock.hpp"

namespace bpa::camera {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Copies what streams deliver into an .oni file. Keeps its first failure for the end.
class Recording {
 public:
  Recording(OniWriter writer, LogHook hook) : writer_(std::move(writer)), log_(std::move(hook)) {}

  void add(const openni::VideoFrameRef& depth, const openni::VideoFrameRef* color) {
    if (!status_.ok()) return;
    status_ = record_frame(writer_, 0, depth);
    if (status_.ok() && color != nullptr) status_ = record_frame(writer_, 1, *color);
    if (!status_.ok()) log(log_, LogLevel::error, "capture: " + status_.message);
  }
  Result<RecordingSummary> finish() {
    if (status_.ok()) status_ = writer_.finish();
    if (!status_.ok()) return status_;
    return RecordingSummary{writer_.path(), writer_.frames(0), writer_.bytes()};
  }

 private:
  OniWriter writer_;
  const LogHook log_;
  Status status_;
};

Image depth_image(const openni::VideoFrameRef& frame, const Openni2Setup& setup) {
  std::vector<std::uint16_t> depth = depth_pixels(frame, setup.depth);
  Image image{PixelFormat::depth_mm, frame.getWidth(), frame.getHeight(), {}};
  if (setup.registrar == Registrar::server) {
    depth = register_depth(depth, setup.geometry);
    image.width = setup.geometry.color.width;
    image.height = setup.geometry.color.height;
  }
  const double unit = setup.geometry.depth_unit;
  if (unit == 1e-3) {
    image.bytes.resize(sizeof(std::uint16_t) * depth.size());
    std::memcpy(image.bytes.data(), depth.data(), image.bytes.size());
    return image;
  }
  image.format = PixelFormat::depth_m;
  std::vector<float> metres(depth.size());
  std::transform(depth.begin(), depth.end(), metres.begin(),
                 [unit](std::uint16_t z) { return static_cast<float>(z * unit); });
  image.bytes.resize(sizeof(float) * metres.size());
  std::memcpy(image.bytes.data(), metres.data(), image.bytes.size());
  return image;
}

class Openni2Device : public CameraDevice {
 public:
  Openni2Device(std::unique_ptr<Openni2Connection> connection, Openni2Setup setup,
                const CameraOptions& options, LogHook hook)
      : connection_(std::move(connection)),
        setup_(std::move(setup)),
        options_(options),
        log_(std::move(hook)),
        complaint_(setup_.complaint),
        first_frame_(connection_->is_recording() ? options.start_frame : 0) {
    if (!connection_->with_color()) return;
    const double period_us = 1e6 / std::max(1, connection_->depth.getVideoMode().getFps());
    pairs_ = FramePairs<openni::VideoFrameRef>(static_cast<std::int64_t>(period_us / 2));
  }

  const std::string& name() const override { return connection_->name(); }
  Result<DeviceOutput> next(milliseconds wait) override;
  std::string complaint() const override { return complaint_; }
  Status start_recording(const std::string& path) override;
  Result<RecordingSummary> stop_recording() override;

 private:
  Status read_one(milliseconds wait);
  std::optional<SensorImages> take_images();
  SensorImages images_of(const openni::VideoFrameRef& depth, std::int64_t depth_us,
                         const openni::VideoFrameRef* color);
  /// Half the time after which a device counts as one that delivers nothing.
  bool color_is_missing() const {
    return Clock::now() - last_color_ > milliseconds(static_cast<int>(options_.timeout_ms / 2));
  }

  const std::unique_ptr<Openni2Connection> connection_;
  const Openni2Setup setup_;
  const CameraOptions options_;
  const LogHook log_;
  std::string complaint_;
  /// Depth frames with a smaller number are skipped one by one: OpenNI2's own seek crashes in the
  /// player of Debian 12 (libOniFile of 2.2.0.33). At most 1: none is skipped any more.
  int first_frame_ = 0;
  FramePairs<openni::VideoFrameRef> pairs_{0};
  HostClock clock_;
  std::int64_t last_depth_us_ = -1;
  Clock::time_point last_color_ = Clock::now();
  std::optional<Recording> recording_;
};

/// Waits for a frame of either stream and keeps it; `timeout` when none comes.
Status Openni2Device::read_one(milliseconds wait) {
  openni::VideoStream* streams[] = {&connection_->depth, &connection_->color};
  int ready = 0;
  const openni::Status waited = openni::OpenNI::waitForAnyStream(
      streams, connection_->with_color() ? 2 : 1, &ready, static_cast<int>(wait.count()));
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
    connection_->device.getPlaybackControl()->setSpeed(static_cast<float>(options_.speed));
  }
  first_frame_ = 0;
  if (stamp < last_depth_us_) pairs_.clear();  // a recording that begins again
  last_depth_us_ = stamp;
  pairs_.add_depth(frame, stamp);
  return {};
}

/// Images of the frames read so far: a pair, or depth alone where no colour is to be expected.
std::optional<SensorImages> Openni2Device::take_images() {
  if (connection_->with_color()) {
    if (const auto pair = pairs_.take()) {
      complaint_.clear();
      return images_of(pair->depth, pair->depth_us, &pair->color);
    }
    if (!color_is_missing()) return std::nullopt;
  }
  const auto depth = pairs_.take_depth();
  if (!depth) return std::nullopt;
  if (connection_->with_color()) complaint_ = "depth comes without colour";
  return images_of(depth->first, depth->second, nullptr);
}

Result<DeviceOutput> Openni2Device::next(milliseconds wait) {
  DeviceOutput output;
  const auto deadline = Clock::now() + wait;
  while (Clock::now() < deadline) {
    if (connection_->gone()) return Status(StatusCode::unavailable, "was pulled out");
    const bool ended = connection_->ended();
    const Status read = read_one(std::min(wait, milliseconds(ended ? 20 : 100)));
    if (read.code == StatusCode::timeout) {
      // A device that keeps them in step gives no depth without colour.
      if (connection_->in_step() && color_is_missing()) (void)connection_->set_in_step(false);
      output.ended = ended;
      if (ended) return output;
      continue;
    }
    if (!read.ok()) return read;
    output.busy = first_frame_ > 1;
    output.images = take_images();
    if (output.images) return output;
  }
  return output;
}

SensorImages Openni2Device::images_of(const openni::VideoFrameRef& depth, std::int64_t depth_us,
                                      const openni::VideoFrameRef* color) {
  if (recording_) recording_->add(depth, color);
  SensorImages images;
  images.stamp_ns = clock_.map(depth_us, unix_time_ns());
  images.depth = depth_image(depth, setup_);
  if (color != nullptr) {
    const bool rgb = color->getVideoMode().getPixelFormat() == openni::PIXEL_FORMAT_RGB888;
    images.color = Image{rgb ? PixelFormat::rgb : PixelFormat::grey, color->getWidth(),
                         color->getHeight(), pixel_bytes_of(*color, setup_.color.mirrored)};
  }
  images.camera = setup_.output.camera;
  images.distortion = setup_.output.distortion;
  return images;
}

Status Openni2Device::start_recording(const std::string& path) {
  std::vector<OniStreamFormat> formats = {
      recorded_format(connection_->depth, OniStreamInfo::Kind::depth)};
  if (connection_->with_color()) {
    formats.push_back(recorded_format(connection_->color, OniStreamInfo::Kind::color));
  }
  auto writer = OniWriter::create(path, formats, setup_.registrar == Registrar::device);
  if (!writer.ok()) return writer.status();
  recording_.emplace(std::move(writer).value(), log_);
  return {};
}

Result<RecordingSummary> Openni2Device::stop_recording() {
  if (!recording_) return CameraDevice::stop_recording();
  Result<RecordingSummary> summary = recording_->finish();
  recording_.reset();
  return summary;
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
    auto connection = Openni2Connection::open(*library, target);
    if (!connection.ok()) return connection.status();
    auto setup = bring_up(**connection, options, hook);
    if (!setup.ok()) return setup.status();
    return std::unique_ptr<CameraDevice>(std::make_unique<Openni2Device>(
        std::move(connection).value(), std::move(setup).value(), options, hook));
  };
}

}  // namespace bpa::camera
