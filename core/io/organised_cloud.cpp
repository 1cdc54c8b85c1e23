// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <sstream>

#include "core/base/concat.hpp"
#include "core/cloud/depth_unit.hpp"
#include "core/io/pcd_file.hpp"

namespace bpa::io {
namespace {

constexpr std::size_t kMinPoints = 500;
constexpr double kMaxMeanResidual = 2.0;  // pixels
constexpr const char* kInCameraFrame =
    "; it must be what one camera sees, in that camera's optical frame: not turned into another "
    "frame, such as a robot's base";

/// Least squares of pixel = f * slope + c over points with slope = x / z: one image axis.
struct AxisFit {
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  Eigen::Vector2d products = Eigen::Vector2d::Zero();

  void add(double slope, double pixel) {
    const Eigen::Vector2d row(slope, 1);
    squares += row * row.transpose();
    products += pixel * row;
  }
  bool solve(double& focal, double& centre) const {
    if (!(squares.determinant() > 1e-9 * squares(1, 1) * squares(1, 1))) return false;
    const Eigen::Vector2d solution = squares.inverse() * products;
    focal = solution[0];
    centre = solution[1];
    return true;
  }
};

/// Where point i of a cloud of that width is stored.
Eigen::Vector2d pixel_of(std::size_t i, int width) {
  return {static_cast<double>(i % width), static_cast<double>(i / width)};
}

Result<Camera> fit_camera(const PcdCloud& cloud, const std::vector<Eigen::Vector3f>& points) {
  AxisFit horizontal, vertical;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i].cast<double>();
    if (!(p.z() > 0)) continue;
    const Eigen::Vector2d pixel = pixel_of(i, cloud.width);
    horizontal.add(p.x() / p.z(), pixel.x());
    vertical.add(p.y() / p.z(), pixel.y());
  }
  Camera camera{cloud.width, cloud.height};
  if (!horizontal.solve(camera.fx, camera.cx) || !vertical.solve(camera.fy, camera.cy)) {
    return invalid_argument(
        "the organised cloud covers too little of the image to find its camera");
  }
  return camera;
}

/// Mean distance in pixels between where points are stored and where the camera sees them.
double mean_residual(const Camera& camera, const std::vector<Eigen::Vector3f>& points) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(points[i].z() > 0)) continue;
    sum += (camera.project(points[i].cast<double>()) - pixel_of(i, camera.width)).norm();
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

/// Points with z = 0 where there is none, z forward, y down; `turned` tells if they had to be.
Result<std::vector<Eigen::Vector3f>> to_optical(const PcdCloud& cloud, bool& turned) {
  std::size_t before = 0, behind = 0;
  for (const Eigen::Vector3f& p : cloud.points) {
    if (!p.allFinite()) continue;
    before += p.z() > 0;
    behind += p.z() < 0;
  }
  if (before + behind < kMinPoints) {
    return invalid_argument("the cloud has ", before + behind,
                            " finite points; it must have at least ", kMinPoints);
  }
  if (before > 0 && behind > 0 && std::min(before, behind) * 100 > before + behind) {
    return invalid_argument("the cloud has points on both sides of z = 0", kInCameraFrame);
  }
  turned = behind > before;
  std::vector<Eigen::Vector3f> points = cloud.points;
  for (Eigen::Vector3f& p : points) {
    if (turned) p = Eigen::Vector3f(p.x(), -p.y(), -p.z());
    if (!p.allFinite() || !(p.z() > 0)) p.setZero();
  }
  return points;
}

std::string camera_note(const Camera& camera, double residual, bool estimated) {
  std::ostringstream text;
  text.precision(1);
  text << std::fixed << "camera " << (estimated ? "estimated from the cloud: " : "given: ")
       << camera.width << "x" << camera.height << ", fx " << camera.fx << ", fy " << camera.fy
       << ", cx " << camera.cx << ", cy " << camera.cy << " pixels (";
  text.precision(3);
  text << "mean residual " << residual << " pixels)";
  return text.str();
}

}  // namespace

Result<OrganisedFrame> frame_from_organised_cloud(const PcdCloud& cloud, const Camera* camera,
                                                  double unit) {
  if (!cloud.organised()) {
    return invalid_argument(
        "the cloud is not organised (its height is 1); a frame needs one point "
        "for each pixel");
  }
  bool turned = false;
  const Result<std::vector<Eigen::Vector3f>> points = to_optical(cloud, turned);
  if (!points.ok()) return points.status();
  const Result<Camera> fitted = camera ? Result<Camera>(*camera) : fit_camera(cloud, *points);
  if (!fitted.ok()) return fitted.status();
  if (fitted->width != cloud.width || fitted->height != cloud.height) {
    return invalid_argument("camera is ", fitted->width, "x", fitted->height, "; it must be ",
                            cloud.width, "x", cloud.height, " as the cloud");
  }
  if (!camera && (fitted->fx <= 0 || fitted->fy <= 0)) {
    return invalid_argument("the cloud runs against its rows or columns", kInCameraFrame);
  }
  if (Status status = validate(*fitted); !status.ok()) return status;
  const double residual = mean_residual(*fitted, *points);
  if (!(residual <= kMaxMeanResidual)) {
    return invalid_argument("the points are ", residual,
                            " pixels from where the camera sees them; the mean must be at most ",
                            kMaxMeanResidual, kInCameraFrame);
  }

  OrganisedFrame result;
  result.frame.camera = *fitted;
  result.frame.depth.resize(points->size());
  const auto metres = static_cast<float>(unit > 0 ? unit : 1);
  for (std::size_t i = 0; i < points->size(); ++i) {
    result.frame.depth[i] = metres * (*points)[i].z();
  }
  const std::string millimetres = unit > 0 ? "" : to_metres(result.frame.depth);
  for (const auto& color : cloud.colors) {
    result.frame.color.insert(result.frame.color.end(), color.begin(), color.end());
  }
  result.notes.push_back(camera_note(*fitted, residual, camera == nullptr));
  if (!millimetres.empty()) result.notes.push_back(millimetres);
  if (turned) {
    result.cloud_from_camera.rotation = Eigen::Quaterniond(0, 1, 0, 0);
    result.notes.push_back(
        "the cloud has y up and z toward the viewer: it was turned half round x into the optical "
        "frame, and poses are given in the cloud's own frame");
  }
  return result;
}

PointCloud drop_invalid_points(const PointCloud& cloud, double scale) {
  PointCloud result = select(cloud, [&](int i) { return cloud.points[i].allFinite(); });
  for (Eigen::Vector3f& p : result.points) p = (scale * p.cast<double>()).cast<float>();
  return result;
}

}  // namespace bpa::io
