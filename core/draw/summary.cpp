// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <functional>

#include <opencv2/imgproc.hpp>

#include "core/base/concat.hpp"
#include "core/draw/annotate.hpp"
#include "core/draw/canvas.hpp"
#include "core/draw/sheet.hpp"

namespace bpa::draw {
namespace {

constexpr double kDimmed = 0.35;     // of the photograph's brightness
constexpr double kSpacing = 0.0025;  // metres between surface points of a model, rounded up

struct Dot {
  double depth = 0;  // metres
  cv::Point at;      // pixels
  int radius = 1;
  cv::Scalar color;
};

// The surface points that face the camera, shaded by how much they do.
void add_dots(const Camera& camera, const Placement& placement, const ObjectModel& model,
              std::vector<Dot>& dots) {
  const PointCloud& surface = model.surface;
  const Rgb plain = object_color(model.number);
  const Eigen::Matrix3d rotation = placement.frame_from_object.matrix();
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3d point = placement.frame_from_object * surface.points[i].cast<double>();
    const double facing = -(rotation * surface.normals[i].cast<double>()).dot(point.normalized());
    if (point.z() < 0.05 || facing <= 0) continue;
    const Eigen::Vector2d pixel = camera.project(point);
    const auto& rgb = surface.colors.empty() ? plain : surface.colors[i];
    dots.push_back({point.z(),
                    {cvRound(pixel.x()), cvRound(pixel.y())},
                    std::max(1, cvRound(kSpacing * camera.fx / point.z())),
                    (0.5 + 0.5 * facing) * cv::Scalar(rgb[0], rgb[1], rgb[2])});
  }
}

// The models of an interpretation in their colours, over the dimmed photograph.
io::ColorImage rendered(const Frame& frame, const Interpretation& interpretation,
                        const ModelLibrary& library) {
  std::vector<Dot> dots;
  for (const Placement& placement : interpretation.placements) {
    const auto model = library.find(placement.model);
    if (model) add_dots(frame.camera, placement, *model, dots);
  }
  std::ranges::stable_sort(dots, std::greater(), &Dot::depth);
  cv::Mat image = kDimmed * to_mat(objects(frame, {}));
  for (const Dot& dot : dots) cv::circle(image, dot.at, dot.radius, dot.color, cv::FILLED);
  return to_image(image);
}

}  // namespace

io::ColorImage summary(const Frame& frame, const std::vector<Interpretation>& interpretations,
                       const ModelLibrary& library, const std::string& caption) {
  constexpr std::size_t kShown = 2;
  io::ColorImage sheet = color_beside_depth(frame, caption);
  std::vector<io::ColorImage> rows{sheet};
  for (std::size_t i = 0; i < std::min(kShown, interpretations.size()); ++i) {
    const Interpretation& one = interpretations[i];
    const std::string title =
        concat("interpretation ", one.rank, ", probability ", fixed(one.probability, 2));
    rows.push_back(
        with_words(beside(annotate(frame, one, library), rendered(frame, one, library)), title));
  }
  return contact_sheet(rows, 1, sheet.width);
}

}  // namespace bpa::draw
