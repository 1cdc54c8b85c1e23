// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "camera/open_camera.hpp"
#include "core/base/clock.hpp"
#include "core/base/concat.hpp"
#include "idl/wire/time.hpp"
#include "ros/bag_frames.hpp"

namespace bpa::camera {
namespace {

using Clock = std::chrono::steady_clock;

/// Plays a recording of ROS 2. Stamps of frames and transforms are moved to the time of playing.
class BagCamera : public CameraDevice {
 public:
  BagCamera(const CameraOptions& options, OnTransforms on_transforms)
      : options_(options),
        path_(options.source.substr(std::string(kBagSource).size())),
        name_("the recording " + path_),
        on_transforms_(std::move(on_transforms)) {}

  /// From the beginning, to be shown from now on.
  Status open() {
    first_ns_.reset();
    early_.clear();
    auto bag =
        ros::BagFrames::open(path_, options_.bag_topics, 0, [this](auto message, bool fixed) {
          if (!first_ns_) return early_.emplace_back(std::move(message), fixed), void();
          hand_on(std::move(message), fixed);
        });
    if (!bag.ok()) return bag.status();
    bag_.emplace(std::move(bag).value());
    for (int number = 1;; ++number) {
      auto frame = bag_->next();
      if (!frame.ok()) return frame.status();
      if (!*frame) {
        return invalid_argument("capture.start_frame is ", options_.start_frame, "; ", path_,
                                " has ", number - 1, " frames");
      }
      if (number < options_.start_frame) continue;
      if ((*frame)->ok()) hold(std::move(**frame).value());
      return {};
    }
  }

  const std::string& name() const override { return name_; }
  std::string complaint() const override { return complaint_; }

  Result<DeviceOutput> next(std::chrono::milliseconds wait) override {
    DeviceOutput output;
    if (!frame_) {
      auto next = bag_->next();
      if (!next.ok()) return Status(next.status().code, "fails: " + next.status().message);
      if (!*next) {
        output.ended = !options_.loop;
        if (const Status status = output.ended ? Status() : open(); !status.ok()) return status;
        output.busy = true;
        return output;
      }
      complaint_ = (*next)->status().message;
      output.busy = !(*next)->ok();
      if (output.busy) return output;
      hold(std::move(**next).value());
    }
    const std::int64_t stamp_ns = played(frame_->stamp_ns);
    if (!options_.every_frame) {
      const auto due = begun_ + std::chrono::nanoseconds(stamp_ns - begun_ns_);
      const auto until = std::min(due, Clock::now() + wait);
      std::this_thread::sleep_until(until);
      output.busy = until < due;
      if (output.busy) return output;
    }
    std::string frame_id = std::move(frame_->frame_id);
    output.images = images_of(*std::exchange(frame_, std::nullopt), options_.color);
    output.images->stamp_ns = stamp_ns;
    output.images->frame_id = std::move(frame_id);
    return output;
  }

 private:
  /// The frame that is shown next. The first one is shown now, and tells when the rest is.
  void hold(Frame frame) {
    if (!first_ns_) {
      first_ns_ = frame.stamp_ns;
      begun_ = Clock::now();
      begun_ns_ = unix_time_ns();
      for (auto& [message, is_static] : std::exchange(early_, {})) {
        hand_on(std::move(message), is_static);
      }
    }
    frame_.emplace(std::move(frame));
  }

  void hand_on(wire::tf2_msgs::TFMessage message, bool is_static) {
    if (!on_transforms_) return;
    for (auto& transform : message.transforms) {
      wire::builtin_interfaces::Time& stamp = transform.header.stamp;
      stamp = wire::builtin_interfaces::from_ns(played(to_ns(stamp)));
    }
    on_transforms_(message, is_static);
  }

  /// When a stamp of the recording is played.
  std::int64_t played(std::int64_t stamp_ns) const {
    const auto since = static_cast<double>(stamp_ns - *first_ns_) / options_.speed;
    return begun_ns_ + static_cast<std::int64_t>(since);
  }

  const CameraOptions options_;
  const std::string path_, name_;
  const OnTransforms on_transforms_;
  std::optional<ros::BagFrames> bag_;
  std::optional<Frame> frame_;            ///< The next one, before it is due.
  std::optional<std::int64_t> first_ns_;  ///< Stamp of the first frame that was shown.
  std::vector<std::pair<wire::tf2_msgs::TFMessage, bool>> early_;  ///< Transforms before it.
  Clock::time_point begun_;
  std::int64_t begun_ns_ = 0;
  std::string complaint_;
};

}  // namespace

Result<std::unique_ptr<CameraDevice>> open_bag_camera(const CameraOptions& options,
                                                      const OnTransforms& on_transforms) {
  auto camera = std::make_unique<BagCamera>(options, on_transforms);
  if (Status status = camera->open(); !status.ok()) return status;
  return std::unique_ptr<CameraDevice>(std::move(camera));
}

}  // namespace bpa::camera
