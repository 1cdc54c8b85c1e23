// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/search_request.hpp"

#include <charconv>
#include <optional>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base/concat.hpp"
#include "core/doctor/frame_check.hpp"
#include "core/io/image_file.hpp"
#include "core/io/pcd_file.hpp"
#include "server/services/requests.hpp"

namespace bpa::server::web {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxCorners = 10000;  ///< Of a region that is drawn by hand.
constexpr std::size_t kMaxUploadPixels = std::size_t{4096} * 4096;

Result<std::vector<std::uint8_t>> mask_of(const Json& polygon, const Camera& camera) {
  std::vector<cv::Point> corners;
  for (const Json& corner : polygon) {
    const auto [x, y] = corner.get<std::pair<double, double>>();
    if (!(std::abs(x) <= io::kMaxImageSide && std::abs(y) <= io::kMaxImageSide)) {
      return invalid_argument("polygon has a corner at (", x, ", ", y,
                              "); it must be near the image");
    }
    corners.emplace_back(cvRound(x), cvRound(y));
    if (corners.size() > kMaxCorners) {
      return invalid_argument("polygon has more than ", kMaxCorners, " corners");
    }
  }
  if (corners.size() < 3) return invalid_argument("polygon must have 3 corners or more");
  std::vector<std::uint8_t> mask(
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height), 0);
  cv::Mat image(camera.height, camera.width, CV_8U, mask.data());
  cv::fillPoly(image, std::vector<std::vector<cv::Point>>{corners}, cv::Scalar(255));
  return mask;
}

/// The frame with the region and mask of a request on it.
Result<Frame> restricted(const Json& json, const Frame& frame) {
  Frame out = frame;
  if (json.contains("region")) {
    const auto r = json["region"].get<std::array<int, 4>>();
    out.roi = {r[0], r[1], r[2], r[3]};
  }
  if (json.contains("polygon")) {
    auto mask = mask_of(json["polygon"], frame.camera);
    if (!mask.ok()) return mask.status();
    out.mask = std::move(mask).value();
  }
  if (Status status = validate(out); !status.ok()) return status;
  return out;
}

Result<DetectJob> job_from(const Json& json, const std::shared_ptr<const Frame>& frame,
                           const DetectionOptions& options) {
  wire::bpa_msgs::Detect_Request request;
  if (json.contains("models")) json["models"].get_to(request.models);
  request.top_k = json.value("top_k", 0U);
  request.time_budget_ms = json.value("budget_ms", 0.0);
  request.seed = json.value("seed", std::uint64_t{0});
  std::optional<Frame> narrowed;
  if (frame) {
    Result<Frame> made = restricted(json, *frame);
    if (!made.ok()) return made.status();
    narrowed = std::move(made).value();
  }
  Result<DetectJob> job = detect_job(std::move(request), options);
  if (!job.ok() || !narrowed) return job;
  job->decode = [own = std::make_shared<Frame>(*std::move(narrowed))] {
    return ros::DecodedFrame(std::move(*own));
  };
  return job;
}

/// A number of the query; `otherwise` without one.
Result<double> number(const Request& request, const char* name, std::optional<double> otherwise) {
  const std::string text = request.value(name);
  if (text.empty() && otherwise) return *otherwise;
  double value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || end.ec != std::errc() || end.ptr != text.data() + text.size()) {
    return invalid_argument(name, " is \"", text, "\"; it must be a number");
  }
  return value;
}

Result<Frame> frame_of_pngs(const Request& request) {
  double values[6] = {};
  constexpr const char* kNames[] = {"depth_bytes", "fx", "fy", "cx", "cy", "depth_scale_mm"};
  for (std::size_t i = 0; i < std::size(kNames); ++i) {
    const Result<double> value =
        number(request, kNames[i], i == 5 ? std::optional<double>(1) : std::nullopt);
    if (!value.ok()) return value.status();
    values[i] = *value;
  }
  const std::string_view body = request.body;
  if (!(values[0] > 0 && values[0] <= static_cast<double>(body.size()))) {
    return invalid_argument("depth_bytes is ", values[0], "; it must be 1 to the ", body.size(),
                            " bytes of the body");
  }
  const auto depth_bytes = static_cast<std::size_t>(values[0]);
  const auto depth = io::decode_depth_png(body.substr(0, depth_bytes), "the depth image");
  if (!depth.ok()) return depth.status();
  std::optional<io::ColorImage> color;
  if (depth_bytes < body.size()) {
    auto image =
        io::decode_color_image(body.substr(depth_bytes), "the colour image", kMaxUploadPixels);
    if (!image.ok()) return image.status();
    color = std::move(image).value();
  }
  const Camera camera{depth->width, depth->height, values[1], values[2], values[3], values[4]};
  return io::frame_of_images(io::depth_of(*depth, values[5]), color ? &*color : nullptr, camera,
                             "of the upload");
}

}  // namespace

Result<DetectJob> search_job(const std::string& text, const std::shared_ptr<const Frame>& frame,
                             const DetectionOptions& options) {
  const Json json = text.empty() ? Json::object() : Json::parse(text, nullptr, false);
  if (!json.is_object()) return invalid_argument("the body must be a JSON object");
  try {
    return job_from(json, frame, options);
  } catch (const Json::exception& error) {
    const std::string what = error.what();  // "[json.exception.type_error.302] type must be ..."
    return invalid_argument("the search cannot be read: ", what.substr(what.find("] ") + 2));
  }
}

Result<Frame> uploaded_frame(const Request& request, double max_range_m) {
  const std::string kind = request.value("kind");
  if (kind != "png" && kind != "pcd") {
    return invalid_argument("kind is \"", kind, "\"; it must be png or pcd");
  }
  Result<Frame> frame = Status(StatusCode::internal, "");
  if (kind == "png") {
    frame = frame_of_pngs(request);
  } else {
    const auto cloud = io::parse_pcd(request.body, "the uploaded cloud");
    if (!cloud.ok()) return cloud.status();
    auto organised = io::frame_from_organised_cloud(*cloud);
    if (!organised.ok()) return organised.status();
    frame = std::move(organised->frame);
  }
  if (!frame.ok()) return frame;
  frame->frame_id = "upload";
  // One thread: others search meanwhile.
  if (Status s = doctor::make_searchable(*frame, max_range_m, 1); !s.ok()) return s;
  return frame;
}

}  // namespace bpa::server::web
