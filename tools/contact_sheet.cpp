// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/contact_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>

#include <opencv2/imgproc.hpp>

#include "core/eval/matching.hpp"
#include "core/eval/pose_errors.hpp"
#include "core/pipeline/annotate.hpp"

namespace bpa::cli {
namespace {

constexpr Rgb kWrong = {255, 40, 40};
constexpr double kMinVisible = 0.1;
constexpr int kHeader = 24;

using Models = std::map<int, std::shared_ptr<const ObjectModel>>;

/// The truth that each placement is right about, or -1.
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
      const PoseError error =
          pose_error(placement.camera_from_object, truth[t].camera_from_object,
                     model->second->symmetry, eval::kRightPosition, eval::kRightAngle);
      const double cost =
          std::max(error.position / eval::kRightPosition, error.angle / eval::kRightAngle);
      if (cost <= 1) costs.back()[t] = cost;
    }
  }
  return eval::match_greedily(scores, costs);
}

cv::Mat to_mat(const io::ColorImage& image) {
  return cv::Mat(image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.pixels.data()))
      .clone();
}

io::ColorImage to_image(const cv::Mat& image) {
  return {image.cols, image.rows, {image.datastart, image.dataend}};
}

cv::Mat with_header(const io::ColorImage& image, const std::string& text) {
  cv::Mat result(image.height + kHeader, image.width, CV_8UC3, cv::Scalar::all(255));
  to_mat(image).copyTo(result(cv::Rect(0, kHeader, image.width, image.height)));
  cv::putText(result, text, {6, 17}, cv::FONT_HERSHEY_SIMPLEX, 0.5, {20, 20, 20}, 1, cv::LINE_AA);
  return result;
}

}  // namespace

AnnotatedFrame truth_beside_result(const Frame& frame, const std::vector<io::BopInstance>& truth,
                                   const Interpretation& result, const ModelLibrary& library,
                                   const std::string& caption) {
  Models models;
  for (const auto& model : library.models()) models[model->number] = model;
  const std::vector<int> truth_of = match(truth, result.placements, models);
  std::vector<DrawnObject> left, right;
  int counted = 0, found_count = 0;
  for (std::size_t t = 0; t < truth.size(); ++t) {
    const auto model = models.find(truth[t].obj_id);
    const bool counts = truth[t].visible_fraction >= kMinVisible;
    const bool found = std::count(truth_of.begin(), truth_of.end(), static_cast<int>(t)) > 0;
    counted += counts;
    found_count += counts && found;
    if (model == models.end()) continue;
    const bool missed = counts && !found;
    left.push_back({&model->second->surface, truth[t].camera_from_object,
                    (missed ? "MISSED " : "") + model->second->name,
                    missed ? kWrong : object_color(truth[t].obj_id), missed});
  }
  int false_count = 0;
  for (std::size_t e = 0; e < result.placements.size(); ++e) {
    const Placement& placement = result.placements[e];
    const auto model = models.find(placement.model_number);
    if (model == models.end()) continue;
    const bool wrong = truth_of[e] < 0;
    false_count += wrong;
    char probability[16];
    std::snprintf(probability, sizeof probability, " %.2f", placement.probability);
    right.push_back({&model->second->surface, placement.camera_from_object,
                     (wrong ? "FALSE " : "") + placement.model + probability,
                     wrong ? kWrong : object_color(placement.model_number), wrong});
  }
  char summary[96];
  std::snprintf(summary, sizeof summary, "result: %d of %d found, %d false", found_count, counted,
                false_count);
  cv::Mat both;
  cv::hconcat(with_header(draw_objects(frame, left), caption + " truth"),
              with_header(draw_objects(frame, right), summary), both);
  return {to_image(both), found_count, counted - found_count, false_count};
}

std::vector<std::size_t> worst_first(const std::vector<AnnotatedFrame>& frames) {
  std::vector<std::size_t> order(frames.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&frames](std::size_t a, std::size_t b) {
    return frames[a].missed + frames[a].wrong > frames[b].missed + frames[b].wrong;
  });
  return order;
}

io::ColorImage color_beside_depth(const Frame& frame, const std::string& caption) {
  constexpr float kNearest = 0.5f, kFarthest = 2.5f, kBand = 0.06f;
  const int width = frame.camera.width, height = frame.camera.height;
  cv::Mat hsv(height, width, CV_8UC3, cv::Scalar::all(0));
  io::ColorImage color{width, height, frame.color};
  color.pixels.resize(3 * frame.depth.size(), 0);
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    const float z = frame.depth[i];
    if (!(z > 0)) continue;
    const float far = std::clamp((z - kNearest) / (kFarthest - kNearest), 0.0f, 1.0f);
    const float band = z / kBand - std::floor(z / kBand);
    hsv.at<cv::Vec3b>(static_cast<int>(i) / width, static_cast<int>(i) % width) = {
        static_cast<std::uint8_t>(140 * far), 230, static_cast<std::uint8_t>(115 + 140 * band)};
  }
  cv::Mat depth;
  cv::cvtColor(hsv, depth, cv::COLOR_HSV2RGB);
  cv::Mat both;
  cv::hconcat(with_header(color, caption), with_header(to_image(depth), ""), both);
  return to_image(both);
}

io::ColorImage contact_sheet(const std::vector<io::ColorImage>& images, int columns,
                             int cell_width) {
  std::vector<cv::Mat> cells;
  int height = 1;
  for (const io::ColorImage& image : images) {
    const double scale = static_cast<double>(cell_width) / image.width;
    cv::Mat cell;
    cv::resize(to_mat(image), cell, {cell_width, cvRound(scale * image.height)}, 0, 0,
               cv::INTER_AREA);
    height = std::max(height, cell.rows);
    cells.push_back(cell);
  }
  const int rows = (static_cast<int>(cells.size()) + columns - 1) / columns;
  cv::Mat sheet(std::max(rows, 1) * (height + 4), columns * (cell_width + 4), CV_8UC3,
                cv::Scalar::all(255));
  for (int i = 0; i < static_cast<int>(cells.size()); ++i) {
    const cv::Mat& cell = cells[static_cast<std::size_t>(i)];
    cell.copyTo(sheet(cv::Rect((i % columns) * (cell_width + 4), (i / columns) * (height + 4),
                               cell.cols, cell.rows)));
  }
  return to_image(sheet);
}

}  // namespace bpa::cli
