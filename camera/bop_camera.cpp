// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <thread>

#include "camera/open_camera.hpp"
#include "core/base/clock.hpp"
#include "core/io/bop_dataset.hpp"

namespace bpa::camera {
namespace {

using Clock = std::chrono::steady_clock;

class BopCamera : public CameraDevice {
 public:
  BopCamera(const std::string& folder, std::vector<io::BopFrame> frames,
            const CameraOptions& options)
      : name_("the data set " + folder),
        frames_(std::move(frames)),
        options_(options),
        next_(static_cast<std::size_t>(std::max(1, options.start_frame)) - 1),
        due_(Clock::now()) {}

  const std::string& name() const override { return name_; }

  Result<DeviceOutput> next(std::chrono::milliseconds wait) override {
    DeviceOutput output;
    if (next_ >= frames_.size()) {
      output.ended = !options_.loop;
      next_ = 0;
      if (output.ended) return output;
    }
    if (!options_.every_frame) {
      const auto until = std::min(due_, Clock::now() + wait);
      std::this_thread::sleep_until(until);
      if (until < due_) return output;
      const std::chrono::duration<double> period(1 / (30 * options_.speed));
      due_ = std::max(due_ + std::chrono::duration_cast<Clock::duration>(period),
                      Clock::now() - std::chrono::seconds(1));
    }
    auto frame = io::load_bop_frame(frames_[next_]);
    if (!frame.ok()) return Status(frame.status().code, "is damaged: " + frame.status().message);
    ++next_;
    output.images = images_of(std::move(frame).value());
    return output;
  }

 private:
  SensorImages images_of(Frame frame) const {
    const int width = frame.camera.width, height = frame.camera.height;
    SensorImages images;
    images.stamp_ns = unix_time_ns();
    images.camera = frame.camera;
    // Metres keep the data set's depth to the last bit, whatever its unit is.
    images.depth = {PixelFormat::depth_m, width, height, bytes_of(frame.depth)};
    if (options_.color && !frame.color.empty()) {
      images.color = Image{PixelFormat::rgb, width, height, std::move(frame.color)};
    }
    return images;
  }

  const std::string name_;
  const std::vector<io::BopFrame> frames_;
  const CameraOptions options_;
  std::size_t next_;
  Clock::time_point due_;
};

}  // namespace

Result<std::unique_ptr<CameraDevice>> open_bop_camera(const std::string& folder,
                                                      const CameraOptions& options) {
  std::string path = folder, split = "test";
  const std::size_t colon = folder.rfind(':');
  if (colon != std::string::npos && !std::filesystem::is_directory(folder)) {
    path = folder.substr(0, colon);
    split = folder.substr(colon + 1);
  }
  auto frames = io::read_bop_frames(path, split);
  if (!frames.ok()) return frames.status();
  const auto count = static_cast<int>(frames->size());
  if (count == 0) return Status(StatusCode::not_found, path + " holds no frames of " + split);
  if (options.start_frame > count) {
    return invalid_argument("capture.start_frame is " + std::to_string(options.start_frame) + "; " +
                            path + " has " + std::to_string(count) + " frames");
  }
  return std::unique_ptr<CameraDevice>(
      std::make_unique<BopCamera>(path, std::move(frames).value(), options));
}

}  // namespace bpa::camera
