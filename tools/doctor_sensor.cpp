// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <future>
#include <memory>

#include "camera/capture.hpp"
#include "camera/open_camera.hpp"
#include "core/base/concat.hpp"
#include "tools/doctor.hpp"

namespace bpa::cli {
namespace {

using camera::SensorImages;

constexpr int kSettle = 15;  // images until automatic exposure has settled, half a second

Frame frame_of(const SensorImages& images) {
  Frame frame;
  frame.camera = images.camera;
  frame.stamp_ns = images.stamp_ns;
  const std::vector<std::uint8_t>& depth = images.depth.bytes;
  if (images.depth.format == camera::PixelFormat::depth_m) {
    frame.depth.resize(depth.size() / sizeof(float));
    std::memcpy(frame.depth.data(), depth.data(), sizeof(float) * frame.depth.size());
  } else {
    std::vector<std::uint16_t> depth_mm(depth.size() / sizeof(std::uint16_t));
    std::memcpy(depth_mm.data(), depth.data(), sizeof(std::uint16_t) * depth_mm.size());
    for (const std::uint16_t z : depth_mm) frame.depth.push_back(0.001f * static_cast<float>(z));
  }
  if (!images.color) return frame;
  const int copies = images.color->format == camera::PixelFormat::grey ? 3 : 1;
  for (const std::uint8_t value : images.color->bytes) {
    frame.color.insert(frame.color.end(), static_cast<std::size_t>(copies), value);
  }
  return frame;
}

/// The capture thread may outlive the call that waits (a driver that hangs), so it shares this.
struct Inbox {
  std::promise<Frame> frame;
  int seen = 0;
};

}  // namespace

Result<Frame> frame_of_sensor(const std::string& source, double timeout_s) {
  camera::CameraOptions options;
  options.source = source;
  if (Status status = camera::check(options); !status.ok()) return status;
  auto open = camera::camera_of(options, nullptr);
  if (!open.ok()) return open.status();
  const bool stored = !source.starts_with("openni2");
  const auto inbox = std::make_shared<Inbox>();
  auto frame = inbox->frame.get_future();
  const camera::Capture capture(
      *std::move(open), {},
      [inbox, wanted = stored ? 1 : kSettle](SensorImages&& images) {
        if (++inbox->seen == wanted) inbox->frame.set_value(frame_of(images));
      },
      nullptr, nullptr);
  if (frame.wait_for(std::chrono::duration<double>(timeout_s)) == std::future_status::ready) {
    return frame.get();
  }
  const camera::CaptureStatus status = capture.status();
  return unavailable(source, " gave no frame within ", timeout_s,
                     " s: ", status.last_attempt.empty() ? status.text : status.last_attempt);
}

}  // namespace bpa::cli
