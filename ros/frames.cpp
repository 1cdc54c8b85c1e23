// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "ros/frames.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "core/base/concat.hpp"
#include "core/cloud/depth_unit.hpp"
#include "core/cloud/undistortion.hpp"
#include "core/io/image_file.hpp"
#include "idl/wire/time.hpp"
#include "ros/images.hpp"

namespace bpa::ros {
namespace {

namespace msgs = wire::bpa_msgs;
namespace sensor = wire::sensor_msgs;

struct Pixels {
  const char* field;
  std::uint32_t count;
};

/// An int holds what this accepts; the rest is refused with the number that was sent.
Status check_pixels(std::initializer_list<Pixels> all) {
  for (const Pixels& pixels : all) {
    if (pixels.count <= io::kMaxImageSide) continue;
    return invalid_argument(pixels.field, " is ", pixels.count, "; it must be at most ",
                            io::kMaxImageSide, " pixels");
  }
  return {};
}

Status check_pixels(std::uint32_t width, std::uint32_t height) {
  return check_pixels({{"camera width", width}, {"camera height", height}});
}

Status check_pixels(const sensor::RegionOfInterest& roi) {
  return check_pixels({{"roi.x_offset", roi.x_offset},
                       {"roi.y_offset", roi.y_offset},
                       {"roi.width", roi.width},
                       {"roi.height", roi.height}});
}

/// The images of a part of the sensor, or of fewer pixels, are not those that k is of.
Status check_whole(const sensor::CameraInfo& info) {
  if (info.binning_x > 1 || info.binning_y > 1) {
    return Status(StatusCode::unsupported,
                  concat("camera info has binning ", info.binning_x, "x", info.binning_y,
                         "; it must be 0 or 1: publish k of the images as they are"));
  }
  const sensor::RegionOfInterest& roi = info.roi;
  const bool whole = roi.width == info.width && roi.height == info.height;
  const bool none = roi.width == 0 && roi.height == 0;
  if (roi.x_offset == 0 && roi.y_offset == 0 && (whole || none)) return {};
  return Status(StatusCode::unsupported,
                concat("camera info has roi ", roi.width, "x", roi.height, " at (", roi.x_offset,
                       ", ", roi.y_offset,
                       "); it must be empty or the whole image: publish k of "
                       "the images as they are"));
}

/// The camera of a row-major 3x3 matrix whose rows are `stride` long. The size has been checked.
Camera camera_of(std::uint32_t width, std::uint32_t height, const double* k, std::size_t stride) {
  return {.width = static_cast<int>(width),
          .height = static_cast<int>(height),
          .fx = k[0],
          .fy = k[stride + 1],
          .cx = k[2],
          .cy = k[stride + 2]};
}

RegionOfInterest roi_of(const sensor::RegionOfInterest& roi) {
  return {static_cast<int>(roi.x_offset), static_cast<int>(roi.y_offset),
          static_cast<int>(roi.width), static_cast<int>(roi.height)};
}

/// The frame with its pixels, from which the lens distortion is taken out, once all is legal.
DecodedFrame completed(Frame frame, const Result<Lens>& lens, const auto& make_depth,
                       const auto& make_color) {
  if (Status status = validate(frame.camera); !status.ok()) {
    return {RejectionCause::camera, status};
  }
  if (!lens.ok()) return {RejectionCause::distortion, lens.status()};
  Result<std::vector<float>> depth = make_depth();
  if (!depth.ok()) return {RejectionCause::depth, depth.status()};
  Result<std::vector<std::uint8_t>> color = make_color();
  if (!color.ok()) return {RejectionCause::color, color.status()};
  frame.depth = std::move(depth).value();
  frame.color = std::move(color).value();
  std::string note = to_metres(frame.depth);
  undistort(*lens, frame);
  clean_depth(frame);
  if (Status status = validate(frame); !status.ok()) return {RejectionCause::frame, status};
  return {std::move(frame), std::move(note)};
}

ImageView view_of(const char* field, const sensor::Image& image) {
  return {field,      image.encoding,          image.width,       image.height,
          image.step, image.is_bigendian != 0, image.data.data(), image.data.size()};
}

Status check_same_size(const char* what, std::uint32_t width, std::uint32_t height,
                       const Camera& camera) {
  if (width == static_cast<std::uint32_t>(camera.width) &&
      height == static_cast<std::uint32_t>(camera.height)) {
    return {};
  }
  return invalid_argument(what, " is ", width, "x", height, " but the camera info is of ",
                          camera.width, "x", camera.height,
                          "; they must be equal (depth registered to colour)");
}

/// Pixels of an image that is as large as the camera's. `from_raw` and `from_compressed` make them.
template <class Pixels>
Result<Pixels> pixels_of(const char* field, const AnyImage& any, const Camera& camera,
                         const auto& from_raw, const auto& from_compressed) {
  const std::string what = std::string(field) + " image";
  if (const auto* raw = std::get_if<sensor::Image>(&any)) {
    const Status status = check_same_size(what.c_str(), raw->width, raw->height, camera);
    if (!status.ok()) return status;
    return from_raw(view_of(field, *raw));
  }
  auto decoded = from_compressed(field, std::get<sensor::CompressedImage>(any));
  if (!decoded.ok()) return decoded.status();
  const Status status = check_same_size(what.c_str(), decoded->width, decoded->height, camera);
  if (!status.ok()) return status;
  return std::move(decoded->pixels);
}

/// The pixels of a message; taken out of it where they need no change.
Result<std::vector<std::uint8_t>> take_color(msgs::RgbdFrame& message) {
  if (message.color_encoding.empty() && message.color.empty()) return std::vector<std::uint8_t>();
  const std::size_t bytes = std::size_t{3} * message.width * message.height;
  if (message.color_encoding == "rgb8" && message.color.size() == bytes) {
    return std::move(message.color);
  }
  return color_from_image({"color", message.color_encoding, message.width, message.height, 0, false,
                           message.color.data(), message.color.size()});
}

OrientationUncertainty orientation_from(const msgs::Bingham& message) {
  OrientationUncertainty orientation;
  orientation.axes = Eigen::Matrix<double, 4, 3>::Map(message.axes.data());
  orientation.concentrations = Eigen::Vector3d::Map(message.concentrations.data());
  return orientation;
}

/// The exponent of the density at q, 0 at its most probable values.
double exponent_at(const OrientationUncertainty& orientation, const Eigen::Vector4d& q) {
  return orientation.concentrations.dot((orientation.axes.transpose() * q).cwiseAbs2());
}

PosePrior prior_from(const msgs::PosePrior& message) {
  PosePrior prior;
  prior.model = message.model;
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const RowMajor covariance = RowMajor::Map(message.position_covariance.data());
  if ((covariance.array() != 0).any()) {
    const auto& p = message.pose.position;
    prior.position = PositionPrior{{p.x, p.y, p.z}, covariance};
  }
  prior.orientation = orientation_from(message.orientation);
  if (message.weight != 0) prior.weight = message.weight;
  return prior;
}

}  // namespace

DecodedFrame frame_from_message(msgs::RgbdFrame message) {
  Status status = check_pixels(message.width, message.height);
  if (!status.ok()) return {RejectionCause::camera, status};
  status = check_pixels(message.roi);
  if (!status.ok()) return {RejectionCause::frame, status};
  Frame frame;
  frame.stamp_ns = to_ns(message.header.stamp);
  frame.frame_id = message.header.frame_id;
  frame.camera = camera_of(message.width, message.height, message.k.data(), 3);
  frame.roi = roi_of(message.roi);
  frame.mask = std::move(message.mask);
  const auto make_depth = [&message] {
    return depth_from_image({"depth", message.depth_encoding, message.width, message.height, 0,
                             false, message.depth.data(), message.depth.size()});
  };
  return completed(std::move(frame), lens_of("", message.d), make_depth,
                   [&message] { return take_color(message); });
}

Status restrict_frame(const msgs::RgbdFrame& message, Frame& frame) {
  const std::string& frame_id = message.header.frame_id;
  if (!message.priors.empty() && !frame_id.empty() && frame_id != frame.frame_id) {
    return invalid_argument("header.frame_id is \"", frame_id,
                            "\", which priors are in; it must be empty or that of the camera, \"",
                            frame.frame_id, "\"");
  }
  if (Status status = check_pixels(message.roi); !status.ok()) return status;
  const RegionOfInterest roi = roi_of(message.roi);
  if (roi.empty() && message.mask.empty()) return {};
  if (!roi.empty()) frame.roi = roi;
  if (!message.mask.empty()) frame.mask = message.mask;
  return validate(frame);
}

Result<std::vector<PosePrior>> priors_from_messages(const std::vector<msgs::PosePrior>& messages) {
  constexpr double kOffMode = -0.5;  // of the exponent: one standard deviation
  std::vector<PosePrior> priors;
  for (const msgs::PosePrior& message : messages) {
    PosePrior prior = prior_from(message);
    const auto& q = message.pose.orientation;
    // Not for numbers that the detector will refuse.
    if (prior.orientation.concentrations.maxCoeff() <= 0 &&
        exponent_at(prior.orientation, {q.w, q.x, q.y, q.z}) < kOffMode) {
      return invalid_argument(
          "priors[", priors.size(),
          "].pose.orientation is not the most probable one of its orientation's "
          "distribution; it must be (axes are in the order w, x, y, z)");
    }
    priors.push_back(std::move(prior));
  }
  return priors;
}

DecodedFrame frame_from_images(const CameraImages& images, bool rectified) {
  const sensor::CameraInfo& info = *images.info;
  for (const Status& status : {check_pixels(info.width, info.height), check_whole(info)}) {
    if (!status.ok()) return {RejectionCause::camera, status};
  }
  Frame frame;
  frame.stamp_ns = to_ns(header_of(*images.depth).stamp);
  frame.frame_id = header_of(*images.depth).frame_id;
  const bool use_projection = rectified && info.p[0] > 0;
  frame.camera = use_projection ? camera_of(info.width, info.height, info.p.data(), 4)
                                : camera_of(info.width, info.height, info.k.data(), 3);
  const Camera camera = frame.camera;
  const auto make_depth = [&] {
    return pixels_of<std::vector<float>>("depth", *images.depth, camera, depth_from_image,
                                         decode_depth);
  };
  const auto make_color = [&]() -> Result<std::vector<std::uint8_t>> {
    if (!images.color) return std::vector<std::uint8_t>();
    return pixels_of<std::vector<std::uint8_t>>("color", *images.color, camera, color_from_image,
                                                decode_color);
  };
  return completed(std::move(frame), rectified ? Lens{} : lens_of(info.distortion_model, info.d),
                   make_depth, make_color);
}

bool named_rectified(const std::string& topic) {
  const std::string name = "_" + topic.substr(topic.rfind('/') + 1);
  return name.find("_rect") != name.npos;
}

}  // namespace bpa::ros
