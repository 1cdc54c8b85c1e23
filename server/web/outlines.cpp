// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/outlines.hpp"

#include <algorithm>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "core/draw/annotate.hpp"

namespace bpa::server::web {
namespace {

using Json = nlohmann::json;

constexpr double kTolerance = 0.7;             ///< Of an outline, pixels.
constexpr double kLeastArea = 12;              ///< Specks are left out, pixels.
constexpr std::size_t kShownAlternatives = 6;  ///< Those with the largest weights.

Json outline(const Camera& camera, const ObjectModel& model, const Pose& pose) {
  draw::Silhouette seen = draw::silhouette(camera, model.surface, pose);
  Json polygons = Json::array();
  if (seen.mask.empty()) return polygons;
  const cv::Mat mask(seen.mask.height, seen.mask.width, CV_8U, seen.mask.pixels.data());
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE, {seen.left, seen.top});
  for (const auto& contour : contours) {
    if (cv::contourArea(contour) < kLeastArea) continue;
    std::vector<cv::Point> corners;
    cv::approxPolyDP(contour, corners, kTolerance, true);
    Json polygon = Json::array();
    for (const cv::Point& corner : corners) {
      polygon.push_back(corner.x);
      polygon.push_back(corner.y);
    }
    polygons.push_back(std::move(polygon));
  }
  return polygons;
}

}  // namespace

std::string outlines_json(const Interpretation& interpretation, const Camera& camera,
                          const Models& models) {
  Json all = Json::array();
  for (const Placement& placement : interpretation.placements) {
    Json one = {{"model", placement.model},
                {"number", placement.model_number},
                {"outline", Json::array()},
                {"alternatives", Json::array()}};
    const auto model = std::ranges::find_if(
        models, [&](const auto& candidate) { return candidate->name == placement.model; });
    if (model != models.end()) {
      one["outline"] = outline(camera, **model, placement.frame_from_object);
      const auto& others = placement.alternatives;
      for (std::size_t i = 0; i < std::min(kShownAlternatives, others.size()); ++i) {
        one["alternatives"].push_back(outline(camera, **model, others[i].frame_from_object));
      }
    }
    all.push_back(std::move(one));
  }
  return all.dump();
}

}  // namespace bpa::server::web
