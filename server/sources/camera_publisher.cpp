// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/sources/camera_publisher.hpp"

#include <cstring>
#include <limits>
#include <utility>

#include "idl/wire/time.hpp"

namespace bpa::server {
wire::sensor_msgs::PointCloud2 cloud_message(const Frame& frame) {
  using wire::sensor_msgs::PointField;
  constexpr std::uint32_t kStep = 16;
  wire::sensor_msgs::PointCloud2 cloud;
  cloud.header = {wire::builtin_interfaces::from_ns(frame.stamp_ns), frame.frame_id};
  cloud.width = static_cast<std::uint32_t>(frame.camera.width);
  cloud.height = static_cast<std::uint32_t>(frame.camera.height);
  cloud.point_fields = {{"x", 0, PointField::kFloat32, 1},
                        {"y", 4, PointField::kFloat32, 1},
                        {"z", 8, PointField::kFloat32, 1},
                        {"rgb", 12, PointField::kFloat32, 1}};
  cloud.point_step = kStep;
  cloud.row_step = kStep * cloud.width;
  cloud.data.resize(std::size_t{cloud.row_step} * cloud.height);
  std::uint8_t* out = cloud.data.data();
  std::size_t i = 0;
  for (int v = 0; v < frame.camera.height; ++v) {
    for (int u = 0; u < frame.camera.width; ++u, ++i, out += kStep) {
      float xyz[3];
      std::fill_n(xyz, 3, std::numeric_limits<float>::quiet_NaN());
      if (frame.depth[i] > 0) {
        const Eigen::Vector3f point = frame.camera.unproject(u, v, frame.depth[i]).cast<float>();
        std::copy_n(point.data(), 3, xyz);
      }
      std::memcpy(out, xyz, sizeof xyz);
      if (frame.color.empty()) continue;
      const std::uint8_t* rgb = frame.color.data() + 3 * i;
      const std::uint8_t bgr0[4] = {rgb[2], rgb[1], rgb[0], 0};  // 0x00RRGGBB
      std::memcpy(out + 12, bgr0, sizeof bgr0);
    }
  }
  return cloud;
}

Result<std::unique_ptr<CameraPublisher>> CameraPublisher::create(
    const wire::Participant& participant, const CaptureOptions& options, LogHook log) {
  std::unique_ptr<CameraPublisher> self(new CameraPublisher(std::move(log)));
  const wire::Qos qos = wire::qos::frames();
  for (const Status& status : {self->color_.open(participant, options.color_topic, qos),
                               self->depth_.open(participant, options.depth_topic, qos),
                               self->color_info_.open(participant, options.color_info_topic, qos),
                               self->depth_info_.open(participant, options.depth_info_topic, qos),
                               self->points_.open(participant, options.points_topic, qos)}) {
    if (!status.ok()) return status;
  }
  self->thread_ = std::thread([raw = self.get()] { raw->run(); });
  return self;
}

CameraPublisher::~CameraPublisher() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void CameraPublisher::publish(const CameraImages& images) {
  if (!color_.wanted() && !depth_.wanted() && !color_info_.wanted() && !depth_info_.wanted() &&
      !points_.wanted()) {
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (next_) ++dropped_;
    next_ = images;
  }
  wake_.notify_one();
}

std::uint64_t CameraPublisher::dropped() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return dropped_;
}

void CameraPublisher::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stopping_ || next_; });
    if (stopping_) return;
    const CameraImages images = *std::exchange(next_, std::nullopt);
    lock.unlock();
    send(images);
    lock.lock();
  }
}

void CameraPublisher::send(const CameraImages& images) {
  using wire::sensor_msgs::Image;
  if (color_info_.wanted()) color_info_.send(*images.info, log_, LogLevel::debug);
  if (depth_info_.wanted()) depth_info_.send(*images.info, log_, LogLevel::debug);
  const auto send_image = [this](Output<Image>& output, const AnyImage* image) {
    const auto* raw = std::get_if<Image>(image);
    if (raw != nullptr && output.wanted()) output.send(*raw, log_, LogLevel::debug);
  };
  send_image(depth_, images.depth.get());
  send_image(color_, images.color.get());
  if (!points_.wanted()) return;
  const auto frame = frame_from_images(images, false);
  if (frame.ok()) points_.send(cloud_message(*frame), log_, LogLevel::debug);
}

}  // namespace bpa::server
