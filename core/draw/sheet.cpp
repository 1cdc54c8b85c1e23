// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/draw/sheet.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/draw/canvas.hpp"

namespace bpa::draw {
namespace {

constexpr int kLine = 24;  // pixels
constexpr int kGap = 4;    // pixels beside and below a cell

// Where each entry of the legend goes: line and x.
std::vector<cv::Point> places(const std::vector<LegendEntry>& legend, int width) {
  std::vector<cv::Point> out;
  cv::Point next(10, 0);
  for (const LegendEntry& entry : legend) {
    const int size = 40 + text_width(entry.text);
    if (next.x > 10 && next.x + size > width) next = {10, next.y + 1};
    out.push_back(next);
    next.x += size;
  }
  return out;
}

}  // namespace

io::ColorImage with_words(const io::ColorImage& picture, const std::string& title,
                          const std::vector<LegendEntry>& legend) {
  if (title.empty()) return picture;
  const std::vector<cv::Point> at = places(legend, picture.width);
  const int lines = at.empty() ? 0 : at.back().y + 1;
  const int header = kLine + 6, footer = lines > 0 ? kLine * lines + 6 : 0;
  cv::Mat sheet(picture.height + header + footer, picture.width, CV_8UC3, cv::Scalar::all(255));
  write(sheet, title, 10, 20, 0.6);
  to_mat(picture).copyTo(sheet(cv::Rect(0, header, picture.width, picture.height)));
  for (std::size_t i = 0; i < legend.size(); ++i) {
    const Rgb& color = legend[i].color;
    const int x = at[i].x, y = header + picture.height + kLine * at[i].y + 8;
    cv::rectangle(sheet, cv::Rect(x, y, 14, 14), {color[0] * 1.0, color[1] * 1.0, color[2] * 1.0},
                  cv::FILLED);
    cv::rectangle(sheet, cv::Rect(x, y, 14, 14), cv::Scalar::all(40), 1);
    write(sheet, legend[i].text, x + 20, y + 12);
  }
  return to_image(sheet);
}

io::ColorImage beside(const io::ColorImage& left, const io::ColorImage& right) {
  cv::Mat both;
  cv::hconcat(to_mat(left), to_mat(right), both);
  return to_image(both);
}

io::ColorImage contact_sheet(const std::vector<io::ColorImage>& pictures, int columns,
                             int cell_width) {
  const int count = static_cast<int>(pictures.size());
  const auto size_of = [&cell_width](const io::ColorImage& picture) {
    const double scale = static_cast<double>(cell_width) / picture.width;
    return cv::Size(cell_width, cvRound(scale * picture.height));
  };
  int height = 0, rows = 0;
  for (bool fits = false; !fits; fits = rows * height <= io::kMaxImageSide) {
    if (height > 0) ++columns;
    cell_width = std::min(cell_width, io::kMaxImageSide / columns - kGap);
    height = 1;
    for (const auto& picture : pictures) height = std::max(height, size_of(picture).height);
    height += kGap;
    rows = std::max(1, (count + columns - 1) / columns);
  }
  const int width = cell_width + kGap;
  cv::Mat sheet(rows * height, columns * width, CV_8UC3, cv::Scalar::all(255));
  for (int i = 0; i < count; ++i) {
    const cv::Point corner((i % columns) * width, (i / columns) * height);
    const cv::Size size = size_of(pictures[i]);
    cv::resize(to_mat(pictures[i]), sheet(cv::Rect(corner, size)), size, 0, 0, cv::INTER_AREA);
  }
  return to_image(sheet);
}

io::ColorImage depth_picture(const Frame& frame) {
  constexpr float kNearest = 0.5f, kFarthest = 2.5f, kBand = 0.06f;
  const int width = frame.camera.width, height = frame.camera.height;
  cv::Mat hsv(height, width, CV_8UC3, cv::Scalar::all(0));
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
  return to_image(depth);
}

io::ColorImage color_beside_depth(const Frame& frame, const std::string& caption) {
  io::ColorImage color{frame.camera.width, frame.camera.height, frame.color};
  color.pixels.resize(3 * frame.depth.size(), 0);
  return with_words(beside(color, depth_picture(frame)), caption);
}

}  // namespace bpa::draw
