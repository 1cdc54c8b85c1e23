// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/draw/scene_features.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "core/draw/annotate.hpp"

namespace bpa::draw {
namespace {

constexpr Rgb kOccluding{255, 50, 50}, kOccluded{60, 110, 255}, kCurvature{40, 220, 70},
    kImage{250, 220, 40};
constexpr float kDarkened = 0.45f;

void set(io::ColorImage& image, int u, int v, const Rgb& color) {
  std::copy(color.begin(), color.end(), image.pixels.begin() + 3 * (v * image.width + u));
}

// Calls visit(u, v, index) for every pixel of the picture that lies in a pixel of a map.
void for_each_pixel(const io::ColorImage& picture, const auto& map, const auto& visit) {
  if (map.empty()) return;
  const int reduction = std::max(1, picture.width / map.width);
  for (int v = 0; v < std::min(picture.height, map.height * reduction); ++v) {
    for (int u = 0; u < std::min(picture.width, map.width * reduction); ++u) {
      visit(u, v, map.index(u / reduction, v / reduction));
    }
  }
}

io::ColorImage dimmed(const Frame& frame) {
  io::ColorImage picture = objects(frame, {});
  for (std::uint8_t& v : picture.pixels) v = static_cast<std::uint8_t>(kDarkened * v);
  return picture;
}

io::ColorImage black(const Frame& frame) {
  const auto size = static_cast<std::size_t>(3 * frame.camera.width * frame.camera.height);
  return {frame.camera.width, frame.camera.height, std::vector<std::uint8_t>(size, 0)};
}

Rgb rgb_of_lab(const Eigen::Vector3f& lab) {
  cv::Mat color(1, 1, CV_32FC3, cv::Scalar(lab[0], lab[1], lab[2]));
  cv::cvtColor(color, color, cv::COLOR_Lab2RGB);
  color.convertTo(color, CV_8U, 255);
  const auto& rgb = color.at<cv::Vec3b>(0, 0);
  return {rgb[0], rgb[1], rgb[2]};
}

Rgb shade(const Eigen::Vector3f& normal) {
  Rgb out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float part = 0.5f + 0.5f * normal[static_cast<int>(k)] * (k == 2 ? -1.0f : 1.0f);
    out[k] = static_cast<std::uint8_t>(255 * std::clamp(part, 0.0f, 1.0f));
  }
  return out;
}

// Whether two labels touch with low affinity, or one of them is no segment.
bool is_boundary(const segment::Segmentation& segmentation, std::int32_t a, std::int32_t b) {
  if (a < 0 || b < 0) return true;
  const auto [first, second] = std::minmax(a, b);
  const auto key = [](const segment::SegmentPair& pair) {
    return std::pair(pair.first, pair.second);
  };
  const std::pair wanted(first, second);
  const auto found = std::ranges::lower_bound(segmentation.pairs, wanted, {}, key);
  return found == segmentation.pairs.end() || key(*found) != wanted || found->affinity < 0.5f;
}

}  // namespace

io::ColorImage edges(const Frame& frame, const features::SceneEdges& found) {
  io::ColorImage picture = dimmed(frame);
  for_each_pixel(picture, found.range, [&](int u, int v, std::size_t i) {
    if (found.range[i] == features::RangeEdge::occluding) {
      set(picture, u, v, kOccluding);
    } else if (found.range[i] == features::RangeEdge::occluded) {
      set(picture, u, v, kOccluded);
    } else if (found.curvature[i]) {
      set(picture, u, v, kCurvature);
    } else if (found.image[i]) {
      set(picture, u, v, kImage);
    }
  });
  return picture;
}

io::ColorImage edge_image(const Frame& frame, const Image<float>& likelihood) {
  io::ColorImage picture = black(frame);
  for_each_pixel(picture, likelihood, [&](int u, int v, std::size_t i) {
    const auto grey = static_cast<std::uint8_t>(255 * std::clamp(likelihood[i], 0.0f, 1.0f));
    set(picture, u, v, {grey, grey, grey});
  });
  return picture;
}

io::ColorImage segment_borders(const Frame& frame, const segment::Segmentation& segmentation) {
  io::ColorImage picture = objects(frame, {});
  const Image<std::int32_t>& labels = segmentation.labels;
  if (labels.empty()) return picture;
  const int reduction = std::max(1, picture.width / labels.width);
  const auto mark = [&](int u, int v, std::int32_t a, std::int32_t b) {
    if (a == b) return;
    const std::uint8_t grey = is_boundary(segmentation, a, b) ? 255 : 0;
    set(picture, u, v, {grey, grey, grey});
  };
  for_each_pixel(picture, labels, [&](int u, int v, std::size_t i) {
    const int x = u / reduction, y = v / reduction;
    const bool last_column = (u + 1) % reduction == 0 && x + 1 < labels.width;
    const bool last_row = (v + 1) % reduction == 0 && y + 1 < labels.height;
    if (last_column) mark(u, v, labels[i], labels.at(x + 1, y));
    if (last_row) mark(u, v, labels[i], labels.at(x, y + 1));
  });
  return picture;
}

io::ColorImage segment_matches(const Frame& frame, const segment::Segmentation& segmentation,
                               const std::vector<score::SegmentMatch>& matches) {
  io::ColorImage picture = dimmed(frame);
  std::vector<double> probability(segmentation.segments.size(), -1);
  for (const score::SegmentMatch& match : matches) probability[match.segment] = match.probability;
  for_each_pixel(picture, segmentation.labels, [&](int u, int v, std::size_t i) {
    const std::int32_t label = segmentation.labels[i];
    const double p = label < 0 ? -1 : probability[label];
    if (p < 0) return;
    const double tint[3] = {1 - p, p, 0};
    std::uint8_t* pixel = picture.pixels.data() + 3 * (v * picture.width + u);
    for (int k = 0; k < 3; ++k) {
      pixel[k] = static_cast<std::uint8_t>(0.5 * pixel[k] + 140 * tint[k]);
    }
  });
  return picture;
}

io::ColorImage segment_means(const Frame& frame, const segment::Segmentation& segmentation) {
  std::vector<Rgb> colors;
  const bool colored = !frame.color.empty();
  for (const segment::Segment& segment : segmentation.segments) {
    colors.push_back(colored ? rgb_of_lab(segment.mean_color) : shade(segment.mean_normal));
  }
  io::ColorImage picture = black(frame);
  for_each_pixel(picture, segmentation.labels, [&](int u, int v, std::size_t i) {
    const std::int32_t label = segmentation.labels[i];
    if (label >= 0) set(picture, u, v, colors[label]);
  });
  return picture;
}

}  // namespace bpa::draw
