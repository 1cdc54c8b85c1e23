// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <utility>

#include "camera/open_camera.hpp"
#include "camera/openni2.hpp"
#include "camera/stamps.hpp"
#include "core/base/clock.hpp"

namespace bpa::camera {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

class Openni2Device : public CameraDevice {
 public:
  Openni2Device(std::unique_ptr<Openni2Connection> connection, const CameraOptions& options,
                LogHook hook)
      : connection_(std::move(connection)),
        options_(options),
        log_(std::move(hook)),
        complaint_(connection_->complaint),
        first_frame_(connection_->file ? options.start_frame : 0),
        pairs_(500'000 / std::max(1, connection_->depth.getVideoMode().getFps())) {}

  const std::string& name() const override { return connection_->name; }
  std::string complaint() const override { return complaint_; }

  Result<DeviceOutput> next(milliseconds wait) override {
    DeviceOutput output;
    const auto deadline = Clock::now() + wait;
    while (Clock::now() < deadline) {
      if (connection_->gone) return Status(StatusCode::unavailable, "was pulled out");
      const bool ended = connection_->ended;
      const Status read = read_one(std::min(wait, milliseconds(ended ? 20 : 100)));
      if (read.code == StatusCode::timeout) {
        // A device that keeps them in step gives no depth without colour.
        if (connection_->in_step && color_is_missing()) (void)connection_->set_in_step(false);
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

  Status start_recording(const std::string& path) override {
    std::vector<OniStreamFormat> formats = {
        recorded_format(connection_->depth, OniStreamInfo::Kind::depth)};
    if (connection_->with_color()) {
      formats.push_back(recorded_format(connection_->color, OniStreamInfo::Kind::color));
    }
    auto writer = OniWriter::create(path, formats, connection_->registrar == Registrar::device);
    if (!writer.ok()) return writer.status();
    writer_.emplace(std::move(writer).value());
    written_ = {};
    return {};
  }

  Result<std::uint64_t> recorded_bytes() const override {
    if (!written_.ok()) return written_;
    return writer_ ? writer_->bytes() : 0;
  }

  Result<RecordingSummary> stop_recording() override {
    if (!writer_) return CameraDevice::stop_recording();
    if (written_.ok()) written_ = writer_->finish();
    const RecordingSummary summary{writer_->path(), writer_->frames(0), writer_->bytes()};
    writer_.reset();
    if (!written_.ok()) return written_;
    return summary;
  }

 private:
  /// Waits for a frame of either stream and keeps it; `timeout` when none comes.
  Status read_one(milliseconds wait) {
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
  std::optional<SensorImages> take_images() {
    if (connection_->with_color()) {
      if (const auto pair = pairs_.take()) {
        complaint_.clear();
        return images_of(pair->depth, &pair->color);
      }
      if (!color_is_missing()) return std::nullopt;
    }
    const auto depth = pairs_.take_depth();
    if (!depth) return std::nullopt;
    if (connection_->with_color()) complaint_ = "depth comes without colour";
    return images_of(depth->first, nullptr);
  }

  /// Copies a frame as it came into the recording.
  void record(std::size_t stream, const openni::VideoFrameRef& frame) {
    if (!writer_ || !written_.ok()) return;
    const std::vector<std::uint8_t> bytes = pixel_bytes_of(frame, false);
    written_ = writer_->add(stream, static_cast<std::int64_t>(frame.getTimestamp()), bytes.data(),
                            bytes.size());
    if (!written_.ok()) log(log_, LogLevel::error, "capture: " + written_.message);
  }

  /// `color` may be nullptr.
  SensorImages images_of(const openni::VideoFrameRef& depth, const openni::VideoFrameRef* color) {
    record(0, depth);
    if (color != nullptr) record(1, *color);
    SensorImages images;
    images.stamp_ns = clock_.map(static_cast<std::int64_t>(depth.getTimestamp()), unix_time_ns());
    images.depth = depth_image(depth);
    if (color != nullptr) {
      const bool rgb = color->getVideoMode().getPixelFormat() == openni::PIXEL_FORMAT_RGB888;
      images.color = Image{rgb ? PixelFormat::rgb : PixelFormat::grey, color->getWidth(),
                           color->getHeight(), pixel_bytes_of(*color, connection_->color_mirrored)};
    }
    images.camera = connection_->geometry.color;
    images.distortion = connection_->geometry.color_distortion;
    return images;
  }

  Image depth_image(const openni::VideoFrameRef& frame) const {
    const DeviceGeometry& geometry = connection_->geometry;
    auto depth = depth_pixels(frame, connection_->depth_mirrored, connection_->max_depth);
    int width = frame.getWidth(), height = frame.getHeight();
    if (connection_->registrar == Registrar::server) {
      depth = register_depth(depth, geometry);
      width = geometry.color.width;
      height = geometry.color.height;
    }
    const double unit = geometry.depth_unit;
    if (unit == 1e-3) return {PixelFormat::depth_mm, width, height, bytes_of(depth)};
    std::vector<float> metres(depth.size());
    std::ranges::transform(depth, metres.begin(),
                           [unit](std::uint16_t z) { return static_cast<float>(z * unit); });
    return {PixelFormat::depth_m, width, height, bytes_of(metres)};
  }

  /// Half the time after which a device counts as one that delivers nothing.
  bool color_is_missing() const {
    return Clock::now() - last_color_ > milliseconds(static_cast<int>(options_.timeout_ms / 2));
  }

  const std::unique_ptr<Openni2Connection> connection_;
  const CameraOptions options_;
  const LogHook log_;
  std::string complaint_;
  /// Depth frames with a smaller number are skipped one by one: OpenNI2's own seek crashes in the
  /// player of Debian 12 (libOniFile of 2.2.0.33). At most 1: none is skipped any more.
  int first_frame_;
  FramePairs<openni::VideoFrameRef> pairs_;  ///< Half a period apart at most.
  HostClock clock_;
  std::int64_t last_depth_us_ = -1;
  Clock::time_point last_color_ = Clock::now();
  std::optional<OniWriter> writer_;  ///< Of the recording that is being made.
  Status written_;                   ///< Its first failure.
};

}  // namespace

OpenCamera openni2_camera(const std::string& uri, const CameraOptions& options, LogHook hook) {
  // Drivers stay loaded between attempts, so that they notice a device that comes back. Loading
  // them again is no way: OpenNI2 holds a lock while it ends a driver, which deadlocks with one
  // that announces a device just then.
  auto library = std::make_shared<std::optional<std::shared_ptr<void>>>();
  return
      [uri, options, hook = std::move(hook), library]() -> Result<std::unique_ptr<CameraDevice>> {
        if (!*library) {
          const auto loaded = load_openni2();
          if (!loaded.ok()) return loaded.status();
          *library = *loaded;
        }
        auto connection = Openni2Connection::open(**library, uri, options, hook);
        if (!connection.ok()) return connection.status();
        return std::unique_ptr<CameraDevice>(
            std::make_unique<Openni2Device>(std::move(connection).value(), options, hook));
      };
}

}  // namespace bpa::camera
