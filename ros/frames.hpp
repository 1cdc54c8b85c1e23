// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "core/result/pose_prior.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "idl/wire/msg/sensor_msgs.hpp"

// Messages -> frames that are fit for the detector: sizes, camera and depth are checked here, once,
// and everything behind may rely on them. Failures name the field, its value and the rule.

namespace bpa::ros {

/// The part of a message that kept it from becoming a frame.
enum class RejectionCause { camera, distortion, depth, color, cloud, priors, frame };

/// Names of the causes, by number; `frame`: too few depths, or a mask or region that does not fit.
inline constexpr const char* kRejectionCauses[] = {"camera", "distortion", "depth", "color",
                                                   "cloud",  "priors",     "frame"};

/// A frame, or why there is none.
class DecodedFrame : public Result<Frame> {
 public:
  DecodedFrame(Frame frame) : Result(std::move(frame)) {}  // NOLINT: implicit on purpose
  DecodedFrame(Frame frame, std::string note) : Result(std::move(frame)), note_(std::move(note)) {}
  DecodedFrame(RejectionCause cause, Status status) : Result(std::move(status)), cause_(cause) {}

  /// Of no meaning when ok().
  RejectionCause cause() const { return cause_; }
  /// What was assumed of the frame, for people; else empty.
  const std::string& note() const { return note_; }

 private:
  RejectionCause cause_ = RejectionCause::frame;
  std::string note_;
};

/// A frame of bpa_msgs/RgbdFrame but for its priors. Lens distortion is taken out
/// (nearest pixel). Move the message in: pixels that are as a Frame has them are not copied then.
DecodedFrame frame_from_message(wire::bpa_msgs::RgbdFrame message);

/// Puts the region of interest and the mask of a message, if any, on a checked frame. Fails where
/// the message has priors in another frame_id than the frame's.
Status restrict_frame(const wire::bpa_msgs::RgbdFrame& message, Frame& frame);

/// The priors of a message as the detector takes them, which also checks their numbers: camera
/// frame, as the message's. Fails with invalid_argument where pose.orientation is not the most
/// probable one of the distribution that comes with it.
Result<std::vector<PosePrior>> priors_from_messages(
    const std::vector<wire::bpa_msgs::PosePrior>& messages);

/// An image as it came: raw, or as image_transport's plugins compress it.
using AnyImage = std::variant<wire::sensor_msgs::Image, wire::sensor_msgs::CompressedImage>;

inline const wire::std_msgs::Header& header_of(const AnyImage& image) {
  return std::visit([](const auto& one) -> const wire::std_msgs::Header& { return one.header; },
                    image);
}
inline const wire::std_msgs::Header& header_of(const wire::sensor_msgs::CameraInfo& info) {
  return info.header;
}

/// Images of one camera that belong together.
struct CameraImages {
  std::shared_ptr<const AnyImage> color;  ///< nullptr without colour.
  std::shared_ptr<const AnyImage> depth;
  std::shared_ptr<const wire::sensor_msgs::CameraInfo> info;
};

/// A frame of a colour image, the depth image registered to it and their camera. `rectified`:
/// images without distortion, so the camera info's projection matrix p holds; otherwise k and d do.
/// Stamp and frame_id are the depth image's.
DecodedFrame frame_from_images(const CameraImages& images, bool rectified);

/// Whether a topic's last name says that its images are rectified, as image_proc names them
/// (image_rect, image_rect_color): their camera info has the distortion that was taken out.
bool named_rectified(const std::string& topic);

/// A frame of an organised cloud in its camera's optical frame: float32 fields x, y, z, and rgb or
/// rgba if there. The camera is the pinhole that fits the points best. `unit` as of
/// io::frame_from_organised_cloud(). `invalid_argument` for a cloud that no such camera sees, or
/// that is not organised.
DecodedFrame frame_from_cloud(const wire::sensor_msgs::PointCloud2& cloud, double unit = 0);

}  // namespace bpa::ros
