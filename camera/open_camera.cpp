// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/open_camera.hpp"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <thread>
#include <utility>

#include "core/base/clock.hpp"
#include "core/base/concat.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/file_bytes.hpp"

namespace bpa::camera {
namespace {

constexpr std::string_view kOpenni2 = "openni2";
constexpr std::string_view kOneOfOpenni2 = "openni2:";
constexpr std::string_view kBop = "bop:";

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
    output.images = images_of(std::move(frame).value(), options_.color);
    output.images->stamp_ns = unix_time_ns();
    return output;
  }

 private:
  const std::string name_;
  const std::vector<io::BopFrame> frames_;
  const CameraOptions options_;
  std::size_t next_;
  Clock::time_point due_;
};

}  // namespace

SensorImages images_of(Frame frame, bool with_color) {
  const int width = frame.camera.width, height = frame.camera.height;
  SensorImages images;
  images.camera = frame.camera;
  // Metres keep the depth to the last bit, whatever its unit was.
  images.depth = {PixelFormat::depth_m, width, height, bytes_of(frame.depth)};
  if (with_color && !frame.color.empty()) {
    images.color = Image{PixelFormat::rgb, width, height, std::move(frame.color)};
  }
  return images;
}

std::optional<VideoMode> parse_video_mode(const std::string& text) {
  VideoMode mode;
  std::sscanf(text.c_str(), "%4dx%4d@%4d", &mode.width, &mode.height, &mode.fps);
  const auto [least, most] = std::minmax({mode.width, mode.height, mode.fps});
  // Reading skips spaces and ignores what follows; writing does not.
  const bool good = least >= 1 && most <= 8192 && to_string(mode) == text;
  return good ? std::optional(mode) : std::nullopt;
}

std::string to_string(const VideoMode& mode) {
  return concat(mode.width, "x", mode.height, "@", mode.fps);
}

std::string list_of(const std::vector<VideoMode>& modes) {
  std::string text;
  for (auto mode = modes.begin(); mode != modes.end(); ++mode) {
    if (std::find(modes.begin(), mode, *mode) != mode) continue;
    text += (text.empty() ? "" : ", ") + to_string(*mode);
  }
  return text;
}

Status check(const CameraOptions& options) {
  const std::string& source = options.source;
  if (!source.empty() && source != kOpenni2 && !source.starts_with(kOneOfOpenni2) &&
      !source.starts_with(kBop) && !source.starts_with(kBagSource) && !is_recording(source)) {
    return invalid_argument(
        "capture.source is \"" + source +
        "\"; it must be openni2, openni2:URI, a FILE.oni, bop:FOLDER, bag:PATH or empty");
  }
  for (const auto& [field, mode] : {std::pair("capture.depth_mode", options.depth_mode),
                                    std::pair("capture.color_mode", options.color_mode)}) {
    if (parse_video_mode(mode)) continue;
    return invalid_argument(std::string(field) + " is \"" + mode + "\"; it must read 640x480@30");
  }
  for (const char* choice : {"auto", "device", "software", "off"}) {
    if (options.registration == choice) return {};
  }
  return invalid_argument("capture.registration is \"" + options.registration +
                          "\"; it must be one of auto, device, software, off");
}

Result<OpenCamera> camera_of(const CameraOptions& options, const LogHook& log,
                             const OnTransforms& on_transforms) {
  const std::string& source = options.source;
  if (source.starts_with(kBagSource)) {
    return OpenCamera([options, on_transforms] { return open_bag_camera(options, on_transforms); });
  }
  if (source.starts_with(kBop)) {
    const std::string folder = source.substr(kBop.size());
    return OpenCamera([folder, options] { return open_bop_camera(folder, options); });
  }
  if (is_recording(source)) return openni2_camera(source, options, log);
  if (source == kOpenni2) return openni2_camera("", options, log);
  if (source.starts_with(kOneOfOpenni2)) {
    return openni2_camera(source.substr(kOneOfOpenni2.size()), options, log);
  }
  return invalid_argument("capture.source names no camera");
}

Result<std::unique_ptr<CameraDevice>> open_bop_camera(const std::string& folder,
                                                      const CameraOptions& options) {
  std::string path = folder, split = "test";
  const std::size_t colon = folder.rfind(':');
  if (colon != std::string::npos && !io::is_folder(folder)) {
    path = folder.substr(0, colon);
    split = folder.substr(colon + 1);
  }
  auto frames = io::read_bop_frames(path, split);
  if (!frames.ok()) return frames.status();
  const auto count = static_cast<int>(frames->size());
  if (count == 0) return Status(StatusCode::not_found, path + " holds no frames of " + split);
  if (options.start_frame > count) {
    return invalid_argument("capture.start_frame is ", options.start_frame, "; ", path, " has ",
                            count, " frames");
  }
  return std::unique_ptr<CameraDevice>(
      std::make_unique<BopCamera>(path, std::move(frames).value(), options));
}

bool is_recording(const std::string& source) { return source.ends_with(".oni"); }

bool is_paced(const CameraOptions& options) {
  return options.every_frame && (is_recording(options.source) || options.source.starts_with(kBop) ||
                                 options.source.starts_with(kBagSource));
}

}  // namespace bpa::camera
