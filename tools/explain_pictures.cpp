// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/explain_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <opencv2/imgproc.hpp>

#include "core/pipeline/explain.hpp"
#include "core/pipeline/silhouette.hpp"

namespace bpa::cli {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr int kLine = 24;    // pixels
constexpr int kTable = 620;  // pixels
constexpr int kView = 640;   // pixels
constexpr int kViewRows = 480;
const cv::Scalar kPaper(255, 255, 255), kInk(30, 30, 30), kRule(205, 205, 205), kFor(60, 160, 80),
    kAgainst(215, 70, 60);
constexpr Rgb kPlaced{80, 255, 120}, kTrue{255, 255, 255};

cv::Mat to_mat(const io::ColorImage& image) {
  return cv::Mat(image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.pixels.data()))
      .clone();
}

io::ColorImage to_image(const cv::Mat& image) {
  const cv::Mat whole = image.isContinuous() ? image : image.clone();
  return {whole.cols, whole.rows, {whole.datastart, whole.dataend}};
}

void write(cv::Mat& image, const std::string& text, int x, int y, double size = 0.5) {
  cv::putText(image, text, {x, y}, kFont, size, kInk, 1, cv::LINE_AA);
}

void write_right(cv::Mat& image, const std::string& text, int x, int y) {
  int base = 0;
  write(image, text, x - cv::getTextSize(text, kFont, 0.5, 1, &base).width, y);
}

std::string number(double value) {
  if (std::isnan(value)) return "not known";
  char text[32];
  std::snprintf(text, sizeof text, std::abs(value) < 10 ? "%.3f" : "%.1f", value);
  return text;
}

// Where each entry of the legend goes: line and x.
std::vector<cv::Point> places(const std::vector<LegendEntry>& legend, int width) {
  std::vector<cv::Point> out;
  cv::Point next(10, 0);
  for (const LegendEntry& entry : legend) {
    int base = 0;
    const int size = 40 + cv::getTextSize(entry.text, kFont, 0.5, 1, &base).width;
    if (next.x > 10 && next.x + size > width) next = {10, next.y + 1};
    out.push_back(next);
    next.x += size;
  }
  return out;
}

cv::Mat view(const Frame& frame, const Candidate& candidate, const std::vector<Pose>& truths) {
  std::vector<FastPose> true_poses;
  for (const Pose& pose : truths) true_poses.push_back(to_fast(pose));
  const FastPose pose = to_fast(candidate.pose());
  const io::ColorImage image = draw_poses(frame, *candidate.model,
                                          {{{&pose, 1}, kPlaced, DrawnPoses::Style::bold},
                                           {true_poses, kTrue, DrawnPoses::Style::dashed}},
                                          {kView, false});
  cv::Mat out;
  cv::resize(to_mat(image), out, {kView, kViewRows}, 0, 0, cv::INTER_AREA);
  return out;
}

// The surroundings of the placement, of the shape of a view.
RegionOfInterest surroundings(const Frame& frame, const Candidate& candidate) {
  const Camera& camera = frame.camera;
  const Silhouette shape = silhouette(camera, candidate.model->surface, candidate.pose());
  if (shape.mask.empty()) return {0, 0, camera.width, camera.height};
  const int height =
      std::min({camera.height, camera.width * kViewRows / kView,
                std::max(3 * shape.mask.height / 2, 3 * shape.mask.width * kViewRows / kView / 2)});
  const int width = height * kView / kViewRows;
  const int u = shape.left + shape.mask.width / 2 - width / 2;
  const int v = shape.top + shape.mask.height / 2 - height / 2;
  return {std::clamp(u, 0, camera.width - width), std::clamp(v, 0, camera.height - height), width,
          height};
}

// The rows of the table, from the top down.
class Table {
 public:
  Table(cv::Mat& sheet, int x) : sheet_(sheet), x_(x) {}

  void title(const std::string& text) {
    write(sheet_, text, x_ + 10, y_ += kLine);
    rule();
  }
  void row(const std::string& name, const std::string& value) {
    write(sheet_, name, x_ + 10, y_ += kLine);
    write_right(sheet_, value, x_ + 270, y_);
  }
  /// The rest of a row.
  void rest(const std::string& text) { write_right(sheet_, text, x_ + kTable - 10, y_); }
  void bar(double value, double largest) {
    constexpr int kZero = 410, kHalf = 120;
    const int length = cvRound(kHalf * value / std::max(1e-9, largest));
    const cv::Rect area(x_ + kZero + std::min(0, length), y_ - 12, std::abs(length), 14);
    if (length != 0) {
      cv::rectangle(sheet_, area, value > 0 ? kFor : kAgainst, cv::FILLED);
    }
    cv::line(sheet_, {x_ + kZero, y_ - 16}, {x_ + kZero, y_ + 6}, kRule);
    char text[32];
    std::snprintf(text, sizeof text, "%+.2f", value);
    rest(text);
  }
  void rule() {
    cv::line(sheet_, {x_ + 10, y_ + 7}, {x_ + kTable - 10, y_ + 7}, kRule);
    y_ += 4;
  }

 private:
  cv::Mat& sheet_;
  int x_;
  int y_ = 4;
};

void write_components(cv::Mat& sheet, const Candidate& candidate, const ScoreLayer& layer) {
  Table table(sheet, kView);
  table.row("score component", "value");
  table.rest("adds to the log odds");
  table.rule();
  const ScoreFeatures features = score_features(candidate.components);
  ScoreFeatures parts{};
  double largest = std::abs(layer.bias);
  for (std::size_t i = 0; i < kNumScoreFeatures; ++i) {
    parts[i] = layer.components[i].at(features[i]);
    largest = std::max(largest, std::abs(parts[i]));
  }
  const auto names = score_feature_names();
  for (std::size_t i = 0; i < kNumScoreFeatures; ++i) {
    table.row(names[i], number(features[i]));
    table.bar(parts[i], largest);
  }
  table.row("bias", "");
  table.bar(layer.bias, largest);
  table.rule();
  table.row("sum: log odds", number(candidate.score));
  table.row("probability without rivals", number(1 / (1 + std::exp(-candidate.score))));
  table.row("probability among rivals", number(candidate.probability));
  table.title("not in the sum themselves");
  for (const ScoreComponent& component : to_placement(candidate).components) {
    const bool used = std::any_of(names.begin(), names.end(),
                                  [&](const char* name) { return component.name == name; });
    if (!used) table.row(component.name, number(component.value));
  }
}

}  // namespace

io::ColorImage with_words(const io::ColorImage& picture, const std::string& title,
                          const std::vector<LegendEntry>& legend) {
  const std::vector<cv::Point> at = places(legend, picture.width);
  const int lines = at.empty() ? 0 : at.back().y + 1;
  const int header = kLine + 6, footer = lines > 0 ? kLine * lines + 6 : 0;
  cv::Mat sheet(picture.height + header + footer, picture.width, CV_8UC3, kPaper);
  write(sheet, title, 10, 20, 0.6);
  to_mat(picture).copyTo(sheet(cv::Rect(0, header, picture.width, picture.height)));
  for (std::size_t i = 0; i < legend.size(); ++i) {
    const Rgb& color = legend[i].color;
    const int x = at[i].x, y = header + picture.height + kLine * at[i].y + 8;
    cv::rectangle(sheet, cv::Rect(x, y, 14, 14), {color[0] * 1.0, color[1] * 1.0, color[2] * 1.0},
                  cv::FILLED);
    cv::rectangle(sheet, cv::Rect(x, y, 14, 14), kInk, 1);
    write(sheet, legend[i].text, x + 20, y + 12);
  }
  return to_image(sheet);
}

io::ColorImage beside(const io::ColorImage& left, const io::ColorImage& right) {
  cv::Mat both;
  cv::hconcat(to_mat(left), to_mat(right), both);
  return to_image(both);
}

io::ColorImage placement_sheet(const Frame& frame, const Candidate& candidate,
                               const ScoreLayer& layer, const std::vector<Pose>& truths) {
  cv::Mat sheet(2 * kViewRows, kView + kTable, CV_8UC3, kPaper);
  view(frame, candidate, truths).copyTo(sheet(cv::Rect(0, 0, kView, kViewRows)));
  const RegionOfInterest near = surroundings(frame, candidate);
  view(crop(frame, near), candidate, truths)
      .copyTo(sheet(cv::Rect(0, kViewRows, kView, kViewRows)));
  write_components(sheet, candidate, layer);
  std::vector<LegendEntry> legend = {{kPlaced, "placement"}};
  if (!truths.empty()) legend.push_back({kTrue, "truth"});
  return with_words(
      to_image(sheet),
      candidate.model->name + ": best placement, probability " + number(candidate.probability),
      legend);
}

}  // namespace bpa::cli
