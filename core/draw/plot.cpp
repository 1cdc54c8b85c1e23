// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/draw/plot.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/draw/canvas.hpp"

namespace bpa::draw {
namespace {

const cv::Scalar kFrameColor(40, 40, 40);
const cv::Scalar kGrid(222, 222, 222);
constexpr double kNoteSpacing = 16;  // pixels between notes, a line of text
const cv::Scalar kColors[] = {{31, 119, 180}, {214, 39, 40}, {44, 160, 44}, {148, 103, 189}};

void write_centred(cv::Mat& image, const std::string& text, cv::Point at, double size = 0.45) {
  write(image, text, at.x - text_width(text, size) / 2, at.y, size);
}

/// The next of 1, 1.5, 2, 3, 5 and 7.5 times a power of ten that is not smaller; 1 for 0.
double round_up(double value) {
  if (!(value > 0)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 5.0, 7.5}) {
    if (step * power >= value) return step * power;
  }
  return 10 * power;
}

PlotAxes fitted(PlotAxes axes, const std::vector<Series>& series) {
  double x = 0, y = 0;
  for (const Series& s : series) {
    for (const double value : s.x) x = std::max(x, value);
    for (const double value : s.y) y = std::max(y, value);
  }
  if (axes.diagonal) x = y = std::max(x, y);
  if (axes.x_max == 0) axes.x_max = round_up(x);
  if (axes.y_max == 0) axes.y_max = round_up(y);
  return axes;
}

/// From values to pixels.
struct Mapping {
  PlotAxes axes;
  cv::Rect area{70, 50, 540, 360};

  cv::Point operator()(double x, double y) const {
    const double u = (x - axes.x_min) / (axes.x_max - axes.x_min);
    const double v = (y - axes.y_min) / (axes.y_max - axes.y_min);
    return {area.x + cvRound(u * area.width), area.y + area.height - cvRound(v * area.height)};
  }
};

void draw_axes(cv::Mat& image, const Mapping& map) {
  const PlotAxes& axes = map.axes;
  for (int i = 0; i <= 5; ++i) {
    const double x = axes.x_min + (axes.x_max - axes.x_min) * i / 5;
    const double y = axes.y_min + (axes.y_max - axes.y_min) * i / 5;
    cv::line(image, map(x, axes.y_min), map(x, axes.y_max), kGrid);
    cv::line(image, map(axes.x_min, y), map(axes.x_max, y), kGrid);
    write_centred(image, cv::format("%.3g", x), map(x, axes.y_min) + cv::Point(0, 18), 0.4);
    write_centred(image, cv::format("%.3g", y), map(axes.x_min, y) + cv::Point(-22, 4), 0.4);
  }
  cv::rectangle(image, map.area, kFrameColor);
  if (axes.diagonal) {
    cv::line(image, map(axes.x_min, axes.y_min), map(axes.x_max, axes.y_max), {150, 150, 150}, 1,
             cv::LINE_AA);
  }
  write_centred(image, axes.title, {image.cols / 2, 26}, 0.6);
  write_centred(image, axes.x_name, {map.area.x + map.area.width / 2, 452});
  write(image, axes.y_name, 8, 44);
}

/// The color of series `s`, whose name it writes below those before it.
cv::Scalar write_legend(cv::Mat& image, const Mapping& map, std::size_t s, const std::string& name,
                        int thickness) {
  const cv::Scalar& color = kColors[s % std::size(kColors)];
  const cv::Point at(map.area.x + 12, map.area.y + 20 + 20 * static_cast<int>(s));
  cv::line(image, at + cv::Point(0, -4), at + cv::Point(20, -4), color, thickness, cv::LINE_AA);
  write(image, name, at.x + 28, at.y);
  return color;
}

}  // namespace

io::ColorImage line_plot(const PlotAxes& axes, const std::vector<Series>& series) {
  cv::Mat image(480, 640, CV_8UC3, cv::Scalar::all(255));
  const Mapping map{fitted(axes, series)};
  draw_axes(image, map);
  const cv::Rect with_border(map.area.tl(), map.area.size() + cv::Size(1, 1));
  for (std::size_t s = 0; s < series.size(); ++s) {
    const cv::Scalar color = write_legend(image, map, s, series[s].name, 2);
    cv::Point last, noted;
    for (std::size_t i = 0; i < series[s].x.size(); ++i) {
      const cv::Point here = map(series[s].x[i], series[s].y[i]);
      if (!with_border.contains(here)) continue;
      if (i > 0) cv::line(image, last, here, color, 2, cv::LINE_AA);
      cv::circle(image, here, 4, color, cv::FILLED, cv::LINE_AA);
      const bool has_note = i < series[s].notes.size() && !series[s].notes[i].empty();
      if (has_note && cv::norm(here - noted) >= kNoteSpacing) {
        write(image, series[s].notes[i], here.x + 8, here.y + 14, 0.4);
        noted = here;
      }
      last = here;
    }
  }
  return to_image(image);
}

io::ColorImage histogram_plot(const PlotAxes& axes, const std::vector<std::string>& names,
                              const std::vector<std::vector<int>>& counts) {
  cv::Mat image(480, 640, CV_8UC3, cv::Scalar::all(255));
  std::vector<int> totals;
  for (const auto& series : counts) {
    totals.resize(std::max(totals.size(), series.size()), 0);
    for (std::size_t i = 0; i < series.size(); ++i) totals[i] += series[i];
  }
  Mapping map{axes};
  map.axes.y_min = 0;
  const int highest = totals.empty() ? 0 : *std::max_element(totals.begin(), totals.end());
  map.axes.y_max = std::max(5, (highest + 4) / 5 * 5);  // whole numbers at the five lines
  draw_axes(image, map);
  const double width = (axes.x_max - axes.x_min) / static_cast<double>(totals.size());
  std::vector<int> base(totals.size(), 0);
  for (std::size_t s = 0; s < counts.size(); ++s) {
    const cv::Scalar color = write_legend(image, map, s, names[s], 10);
    for (std::size_t i = 0; i < counts[s].size(); ++i) {
      if (counts[s][i] <= 0) continue;
      const double left = axes.x_min + width * static_cast<double>(i);
      const cv::Point low = map(left, base[i]);
      const cv::Point high = map(left + width, base[i] + counts[s][i]);
      cv::rectangle(image, low + cv::Point(2, 0), high - cv::Point(2, 0), color, cv::FILLED);
      base[i] += counts[s][i];
    }
  }
  return to_image(image);
}

io::ColorImage bar_plot(const std::string& title, const std::vector<std::string>& names,
                        const std::vector<double>& values, const std::vector<std::string>& notes) {
  constexpr int kRow = 24, kLeft = 230, kWidth = 320;
  const int height = 60 + kRow * static_cast<int>(names.size());
  cv::Mat image(height, 640, CV_8UC3, cv::Scalar::all(255));
  write_centred(image, title, {320, 26}, 0.6);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int y = 44 + kRow * static_cast<int>(i);
    write(image, names[i].substr(0, 28), 8, y + 14, 0.4);
    cv::rectangle(image, cv::Rect(kLeft, y, kWidth, kRow - 6), kGrid);
    const int length = cvRound(kWidth * std::clamp(values[i], 0.0, 1.0));
    if (length > 0) {
      cv::rectangle(image, cv::Rect(kLeft, y, length, kRow - 6), kColors[0], cv::FILLED);
    }
    write(image, notes[i], kLeft + kWidth + 8, y + 14, 0.4);
  }
  return to_image(image);
}

}  // namespace bpa::draw
