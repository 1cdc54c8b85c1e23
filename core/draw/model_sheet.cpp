// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <opencv2/imgproc.hpp>

#include "core/draw/canvas.hpp"
#include "core/draw/plot.hpp"
#include "core/draw/sheet.hpp"
#include "core/model/model_index.hpp"

namespace bpa::draw {
namespace {

constexpr int kTile = 300;  // pixels
constexpr double kText = 0.38;
constexpr int kColumns = 3, kRows = 3;
constexpr int kPlot = 450, kPlotRows = 338;  // pixels
constexpr float kDiscSpacings = 1.7f;  // radius of a disc, so that discs of the surface overlap
constexpr float kSameSide = 0.5f;      // cosine of normals
const cv::Scalar kBlue(40, 80, 230), kEdge(0, 190, 220);

using Paint = std::function<Eigen::Vector3f(std::size_t)>;  // rgb of a surface point, in [0, 1]

/// Blue over green and yellow to red, for t in [0, 1].
Eigen::Vector3f heat(float t) {
  t = std::clamp(t, 0.0f, 1.0f);
  return {std::clamp(2 * t - 0.5f, 0.0f, 1.0f),
          std::clamp(1.5f - std::abs(2.4f * t - 1), 0.0f, 1.0f),
          std::clamp(1.2f - 2.4f * t, 0.0f, 1.0f)};
}

/// An orthographic look at the model along -direction, `side` x `side` pixels.
class Look {
 public:
  Look(const ObjectModel& model, const Eigen::Vector3f& direction, int side = kTile)
      : model_(model), side_(side) {
    const Eigen::Vector3f up = Eigen::Vector3f::Unit(std::abs(direction.z()) > 0.9f ? 1 : 2);
    axes_.row(2) = direction;
    axes_.row(0) = up.cross(direction).normalized();
    axes_.row(1) = direction.cross(Eigen::Vector3f(axes_.row(0)));
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& p : model.surface.points) box.extend(p);
    middle_ = box.center();
    scale_ = 0.80f * static_cast<float>(side) / static_cast<float>(model.diameter);
    radius_ = std::max(1.0f, kDiscSpacings * scale_ * mean_spacing(model.surface, kSameSide));
  }

  cv::Point place(const Eigen::Vector3f& p) const {
    const Eigen::Vector3f q = scale_ * (axes_ * (p - middle_));
    return {static_cast<int>(std::lround(side_ / 2 + q.x())),
            static_cast<int>(std::lround(side_ / 2 - q.y()))};
  }

  /// The surface of its points. Each is a disc in its tangent plane; where discs of the nearest
  /// surface overlap, their colours are blended.
  cv::Mat draw(const Paint& paint) const {
    cv::Mat depth(side_, side_, CV_32F, cv::Scalar(-1e9));
    for_each_pixel([&depth](std::size_t, int u, int v, float z, float) {
      depth.at<float>(v, u) = std::max(depth.at<float>(v, u), z);
    });
    cv::Mat sum(side_, side_, CV_32FC3, cv::Scalar::all(0)),
        weights(side_, side_, CV_32F, cv::Scalar(0));
    for_each_pixel([&](std::size_t i, int u, int v, float z, float weight) {
      if (z < depth.at<float>(v, u) - radius_) return;
      const float light = 0.35f + 0.65f * axes_.row(2).dot(model_.surface.normals[i]);
      const Eigen::Vector3f rgb = 255 * weight * light * paint(i);
      sum.at<cv::Vec3f>(v, u) += cv::Vec3f(rgb[0], rgb[1], rgb[2]);
      weights.at<float>(v, u) += weight;
    });
    cv::Mat tile(side_, side_, CV_8UC3, cv::Scalar::all(255));
    for (int v = 0; v < side_; ++v) {
      for (int u = 0; u < side_; ++u) {
        const float weight = weights.at<float>(v, u);
        if (weight > 0) tile.at<cv::Vec3b>(v, u) = sum.at<cv::Vec3f>(v, u) / weight;
      }
    }
    return tile;
  }

  void draw_edges(cv::Mat& tile) const {
    const Eigen::Vector3f towards = axes_.row(2);
    const ModelView& view = nearest_view(model_.index->views, towards);
    for (std::size_t k = 0; k < view.visible.size(); ++k) {
      if (view.edge_distance[k] > 0.002f) continue;
      cv::circle(tile, place(model_.surface.points[view.visible[k]]), 1, kEdge, cv::FILLED);
    }
  }

  void draw_axes(cv::Mat& tile) const {
    const auto line = [&](const Eigen::Vector3d& point, const Eigen::Vector3d& axis, int width) {
      const Eigen::Vector3d half = 0.6 * model_.diameter * axis;
      cv::line(tile, place((point - half).cast<float>()), place((point + half).cast<float>()),
               kBlue, width, cv::LINE_AA);
    };
    for (const ContinuousSymmetry& c : model_.symmetry.continuous) line(c.point, c.axis, 2);
    for (const Pose& pose : model_.symmetry.discrete) {
      const Eigen::Vector3d v = vector_from_rotation(pose.rotation);
      if (v.norm() > 1e-6) line(middle_.cast<double>(), v.normalized(), 1);
    }
  }

 private:
  /// Calls visit(point, u, v, depth, weight) for the pixels of the discs that face the viewer.
  /// Depth is in pixels and grows towards the viewer; the weight falls from the middle of a disc.
  void for_each_pixel(auto&& visit) const {
    const int reach = static_cast<int>(std::ceil(radius_));
    for (std::size_t i = 0; i < model_.surface.size(); ++i) {
      const Eigen::Vector3f n = axes_ * model_.surface.normals[i];
      if (n.z() <= 0) continue;
      const cv::Point at = place(model_.surface.points[i]);
      const float z = scale_ * axes_.row(2).dot(model_.surface.points[i]);
      for (int dv = -reach; dv <= reach; ++dv) {
        for (int du = -reach; du <= reach; ++du) {
          const int u = at.x + du, v = at.y + dv;
          if (u < 0 || v < 0 || u >= side_ || v >= side_) continue;
          const auto x = static_cast<float>(du), y = static_cast<float>(-dv);
          const float rise = -(n.x() * x + n.y() * y) / n.z();  // of the tangent plane
          const float off = (x * x + y * y + rise * rise) / (radius_ * radius_);
          if (off <= 1) visit(i, u, v, z + rise, 1.01f - off);
        }
      }
    }
  }

  const ObjectModel& model_;
  const int side_;
  Eigen::Matrix3f axes_;
  Eigen::Vector3f middle_;
  float scale_ = 1;
  float radius_ = 1;  ///< Of the discs, pixels.
};

/// The curve over edge distance (at an angle of 30 degrees) and over angle (3 cm from edges).
cv::Mat noise_plot(const NoiseCurve& curve, const std::string& title, double unit) {
  constexpr int kSteps = 40;
  constexpr double kFarEdge = 0.03, kAngle = M_PI / 6, kSteep = 85 * M_PI / 180;
  Series distance{"by edge distance, 0 to 30 mm, at 30 degrees", {}, {}};
  Series angle{"by angle, 0 to 85 degrees, 30 mm from edges", {}, {}};
  for (int k = 0; k <= kSteps; ++k) {
    const double part = static_cast<double>(k) / kSteps;
    distance.x.push_back(part);
    angle.x.push_back(part);
    distance.y.push_back(unit * curve(part * kFarEdge, kAngle));
    angle.y.push_back(unit * curve(kFarEdge, part * kSteep));
  }
  const PlotAxes axes{title, "part of the range", "standard deviation", 0, 1, 0, 0};
  cv::Mat plot;
  cv::resize(to_mat(line_plot(axes, {distance, angle})), plot, {kPlot, kPlotRows}, 0, 0,
             cv::INTER_AREA);
  return plot;
}

Paint own_colors(const ObjectModel& model) {
  return [&model](std::size_t i) -> Eigen::Vector3f {
    if (model.surface.colors.empty()) return Eigen::Vector3f::Constant(0.75f);
    const auto& c = model.surface.colors[i];
    return Eigen::Vector3f(c[0], c[1], c[2]) / 255;
  };
}

/// The larger eigenvalue of curvature, of the feature point nearest to each surface point.
Paint curvature(const ObjectModel& model) {
  const PointCloud& features = model.index->features;
  const DistanceTransform nearest = distance_transform(features.points, 0.004f, 0.01f);
  std::vector<float> value(model.surface.size(), 0);
  for (std::size_t i = 0; i < value.size(); ++i) {
    const int k = nearest.nearest_to(model.surface.points[i]);
    if (k >= 0) value[i] = features.curvatures[static_cast<std::size_t>(k)].x();
  }
  return [value](std::size_t i) { return heat(2.5f * value[i]); };
}

Look corner_look(const ObjectModel& model, int side) {
  return {model, Eigen::Vector3f(1, -1.2f, 0.9f).normalized(), side};
}

}  // namespace

io::ColorImage model_thumbnail(const ObjectModel& model, int side) {
  const Look corner = corner_look(model, 2 * side);
  cv::Mat tile = corner.draw(own_colors(model));
  corner.draw_axes(tile);
  cv::Mat small;
  cv::resize(tile, small, {side, side}, 0, 0, cv::INTER_AREA);
  return to_image(small);
}

io::ColorImage model_sheet(const ObjectModel& model) {
  cv::Mat sheet(kRows * kTile + kPlotRows, kColumns * kTile, CV_8UC3, cv::Scalar::all(255));
  const auto put = [&sheet](const cv::Mat& tile, int place, const std::string& title) {
    const cv::Rect area(place % kColumns * kTile, place / kColumns * kTile, kTile, kTile);
    tile.copyTo(sheet(area));
    cv::rectangle(sheet, area, cv::Scalar(200, 200, 200), 1);
    write(sheet, title, area.x + 10, area.y + 18, kText);
  };
  const char* const names[] = {"from +x", "from -x", "from +y", "from -y", "from +z", "from -z"};
  const Paint colors = own_colors(model);
  for (int k = 0; k < 6; ++k) {
    const Look look(model, (k % 2 == 0 ? 1.0f : -1.0f) * Eigen::Vector3f::Unit(k / 2));
    cv::Mat tile = look.draw(colors);
    look.draw_edges(tile);
    look.draw_axes(tile);
    put(tile, k, names[k]);
  }
  const Look corner = corner_look(model, kTile);
  cv::Mat tile = corner.draw(colors);
  corner.draw_axes(tile);
  put(tile, 6, "symmetry axes");
  put(corner.draw(curvature(model)), 7, "curvature");
  put(corner.draw(
          [&model](std::size_t i) { return heat(std::sqrt(model.normal_variance[i]) / 0.7f); }),
      8, "normals vary: 0 (blue) to 40 deg (red)");
  const cv::Rect left(0, kRows * kTile, kPlot, kPlotRows);
  noise_plot(model.noise.range, "range noise, mm", 1000).copyTo(sheet(left));
  noise_plot(model.noise.normal, "noise of normals, degrees", 180 / M_PI)
      .copyTo(sheet(left + cv::Point(kPlot, 0)));
  return to_image(sheet);
}

}  // namespace bpa::draw
