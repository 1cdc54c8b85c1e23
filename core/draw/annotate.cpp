// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/draw/annotate.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include <opencv2/imgproc.hpp>

#include "core/base/concat.hpp"
#include "core/draw/canvas.hpp"
#include "core/draw/sheet.hpp"
#include "core/eval/pose_errors.hpp"

namespace bpa::draw {
namespace {

constexpr int kLabelFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFillOpacity = 0.35;

/// Near is bright; black has no depth.
cv::Mat grey_depth(const Frame& frame) {
  constexpr double kBrightest = 230, kDarkest = 50;
  auto* const metres = const_cast<float*>(frame.depth.data());
  const cv::Mat depth(frame.camera.height, frame.camera.width, CV_32F, metres);
  const cv::Mat measured = depth > 0;
  double nearest = 0, furthest = 0;
  cv::minMaxLoc(depth, &nearest, &furthest, nullptr, nullptr, measured);
  const double slope = (kDarkest - kBrightest) / std::max(furthest - nearest, 1e-3);
  cv::Mat grey, image;
  depth.convertTo(grey, CV_8U, slope, kBrightest - slope * nearest);
  grey.setTo(0, ~measured);
  cv::cvtColor(grey, image, cv::COLOR_GRAY2RGB);
  return image;
}

void fill(cv::Mat image, const cv::Mat& mask, const cv::Scalar& color) {
  cv::Mat filled;
  cv::addWeighted(image, 1 - kFillOpacity, cv::Mat(image.size(), image.type(), color), kFillOpacity,
                  0, filled);
  filled.copyTo(image, mask);
}

/// Draws outline and fill; returns the box of the part in the image, empty if there is none.
cv::Rect draw_silhouette(cv::Mat& image, const Camera& camera, const DrawnObject& object) {
  Silhouette shape = silhouette(camera, *object.surface, object.camera_from_object);
  if (shape.mask.empty()) return {};
  const cv::Mat mask(shape.mask.height, shape.mask.width, CV_8U, shape.mask.pixels.data());
  const cv::Point corner(shape.left, shape.top);
  const cv::Scalar color(object.color[0], object.color[1], object.color[2]);
  if (!object.emphasised) fill(image(cv::Rect(corner, mask.size())), mask, color);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE, corner);
  const int thickness = object.emphasised ? 3 : 2;
  cv::drawContours(image, contours, -1, {20, 20, 20}, thickness + 2, cv::LINE_AA);
  cv::drawContours(image, contours, -1, color, thickness, cv::LINE_AA);
  const cv::Rect box = cv::boundingRect(mask);
  return box.empty() ? box : box + corner;
}

/// The rectangle nearest to the wished one, above or below it, that covers none of `taken`.
cv::Rect free_place(cv::Rect wished, cv::Size image, const std::vector<cv::Rect>& taken) {
  wished.x = std::clamp(wished.x, 0, std::max(0, image.width - wished.width));
  wished.y = std::clamp(wished.y, 0, std::max(0, image.height - wished.height));
  for (int step = 0; step < 2 * image.height; ++step) {
    cv::Rect place = wished;
    place.y += (step % 2 == 0 ? 1 : -1) * ((step + 1) / 2) * 2;
    if (place.y < 0 || place.y + place.height > image.height) continue;
    const auto overlaps = [&](const cv::Rect& t) { return (t & place).area() > 0; };
    if (std::ranges::none_of(taken, overlaps)) return place;
  }
  return wished;
}

void draw_label(cv::Mat& image, const DrawnObject& object, const cv::Rect& box,
                std::vector<cv::Rect>& taken) {
  const double scale = 0.42 * std::max(1.0, image.cols / 640.0);
  int base = 0;
  const cv::Size text = cv::getTextSize(object.label, kLabelFont, scale, 1, &base);
  const int margin = 3;
  const cv::Size size(text.width + 2 * margin, text.height + base + 2 * margin);
  const cv::Point middle(box.x + box.width / 2, box.y + box.height / 2);
  const cv::Rect place =
      free_place({middle.x - size.width / 2, box.y - size.height - 2, size.width, size.height},
                 image.size(), taken);
  taken.push_back(place);
  const cv::Scalar color(object.color[0], object.color[1], object.color[2]);
  const cv::Point anchor(std::clamp(middle.x, place.x, place.x + place.width),
                         place.y + place.height / 2);
  if (!place.contains(middle)) cv::line(image, anchor, middle, color, 1, cv::LINE_AA);
  cv::rectangle(image, place, color, cv::FILLED);
  cv::rectangle(image, place, {20, 20, 20}, 1);
  const double luminance = 0.3 * color[0] + 0.59 * color[1] + 0.11 * color[2];
  cv::putText(image, object.label, {place.x + margin, place.y + margin + text.height}, kLabelFont,
              scale, luminance > 130 ? cv::Scalar(0, 0, 0) : cv::Scalar(255, 255, 255), 1,
              cv::LINE_AA);
}

constexpr Rgb kWrong = {255, 40, 40};
constexpr double kMinVisible = 0.1;  // as EvaluationOptions::min_visible_fraction

using Models = std::map<int, std::shared_ptr<const ObjectModel>>;

/// The index of the truth that each placement is right about, or -1.
std::vector<int> match(const std::vector<io::BopInstance>& truth,
                       const std::vector<Placement>& placements, const Models& models) {
  std::vector<double> scores;
  std::vector<std::vector<double>> costs;
  for (const Placement& placement : placements) {
    scores.push_back(placement.probability);
    costs.emplace_back(truth.size(), eval::kNoMatch);
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const auto model = models.find(truth[t].obj_id);
      if (model == models.end() || truth[t].obj_id != placement.model_number) continue;
      costs.back()[t] = eval::right_cost(placement.frame_from_object, truth[t].camera_from_object,
                                         model->second->symmetry);
    }
  }
  return eval::match_greedily(scores, costs);
}

void mark_wrong(DrawnObject& object, const std::string& word) {
  object.label = word + " " + object.label;
  object.color = kWrong;
  object.emphasised = true;
}

}  // namespace

Rgb object_color(int number) {
  // Turn the hue by the golden ratio: neighbours are far apart, and so are the first 30.
  const double turns = 0.61803398875 * number;
  const double hue = 6 * (0.08 + 0.84 * (turns - std::floor(turns)));  // red is for errors
  const double bright = number % 2 == 0 ? 255 : 215;
  Rgb color{};
  const double offsets[] = {5, 3, 1};
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = std::fmod(offsets[k] + hue, 6.0);
    const double level = std::clamp(std::min(x, 4 - x), 0.0, 1.0);
    color[k] = static_cast<std::uint8_t>(bright * (1 - 0.85 * level));
  }
  return color;
}

io::ColorImage objects(const Frame& frame, const std::vector<DrawnObject>& drawn) {
  const io::ColorImage color{frame.camera.width, frame.camera.height, frame.color};
  cv::Mat image = frame.color.empty() ? grey_depth(frame) : to_mat(color);
  std::vector<DrawnObject> furthest_first = drawn;
  std::ranges::stable_sort(furthest_first, std::greater(), [](const DrawnObject& object) {
    return object.camera_from_object.translation.z();
  });
  std::vector<cv::Rect> boxes, taken;
  for (const DrawnObject& object : furthest_first) {
    boxes.push_back(draw_silhouette(image, frame.camera, object));
  }
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].empty()) draw_label(image, furthest_first[i], boxes[i], taken);
  }
  return to_image(image);
}

DrawnObject placed(const Placement& placement, const ObjectModel& model) {
  return {&model.surface, placement.frame_from_object,
          placement.model + " " + fixed(placement.presence, 2) +
              (pose_is_open(placement) ? ", pose open" : ""),
          object_color(placement.model_number), false};
}

io::ColorImage annotate(const Frame& frame, const Interpretation& interpretation,
                        const ModelLibrary& library) {
  std::vector<DrawnObject> drawn;  // of models that the library keeps
  for (const Placement& placement : interpretation.placements) {
    const std::shared_ptr<const ObjectModel> model = library.find(placement.model);
    if (model) drawn.push_back(placed(placement, *model));
  }
  return objects(frame, drawn);
}

JudgedFrame truth_beside_result(const Frame& frame, const std::vector<io::BopInstance>& truth,
                                const Interpretation& result, const ModelLibrary& library,
                                const std::string& caption) {
  Models models;
  for (const auto& model : library.models()) models[model->number] = model;
  const std::vector<int> truth_of = match(truth, result.placements, models);
  JudgedFrame judged;
  std::vector<DrawnObject> left, right;
  for (std::size_t t = 0; t < truth.size(); ++t) {
    const auto model = models.find(truth[t].obj_id);
    const bool counts = truth[t].visible_fraction >= kMinVisible;
    const bool found = std::count(truth_of.begin(), truth_of.end(), static_cast<int>(t)) > 0;
    judged.found += counts && found;
    judged.missed += counts && !found;
    if (model == models.end()) continue;
    left.push_back({&model->second->surface, truth[t].camera_from_object, model->second->name,
                    object_color(truth[t].obj_id), false});
    if (counts && !found) mark_wrong(left.back(), "MISSED");
  }
  for (std::size_t e = 0; e < result.placements.size(); ++e) {
    const auto model = models.find(result.placements[e].model_number);
    if (model == models.end()) continue;
    right.push_back(placed(result.placements[e], *model->second));
    if (truth_of[e] >= 0) continue;
    mark_wrong(right.back(), "FALSE");
    ++judged.wrong;
  }
  const std::string summary = concat("result: ", judged.found, " of ", judged.found + judged.missed,
                                     " found, ", judged.wrong, " false");
  judged.picture = beside(with_words(objects(frame, left), caption + " truth"),
                          with_words(objects(frame, right), summary));
  return judged;
}

std::vector<std::size_t> worst_first(const std::vector<JudgedFrame>& frames) {
  std::vector<std::size_t> order(frames.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(),
                           [&frames](std::size_t i) { return frames[i].missed + frames[i].wrong; });
  return order;
}

}  // namespace bpa::draw
