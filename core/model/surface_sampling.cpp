// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <sstream>

#include <bpa/core/base/random.hpp>
#include <bpa/core/cloud/curvature.hpp>
#include <bpa/core/cloud/neighbor_grid.hpp>
#include <bpa/core/model/object_model.hpp>
#include <bpa/core/model/view_sphere.hpp>

namespace bpa {
namespace {

constexpr double kMinDiameter = 0.005;
constexpr double kMaxDiameter = 3.0;

// Six times the volume that the triangles enclose, negative when they face inwards.
double signed_volume(const TriangleMesh& mesh) {
  const Eigen::Vector3f origin = mesh.vertices.front();
  double volume = 0;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3f a = mesh.vertices[triangle[0]] - origin;
    const Eigen::Vector3f b = mesh.vertices[triangle[1]] - origin;
    const Eigen::Vector3f c = mesh.vertices[triangle[2]] - origin;
    volume += static_cast<double>(a.dot(b.cross(c)));
  }
  return volume;
}

// Points on the triangles, `per_square_metre` on average, with the triangles' normals,
// those of a mesh that is inside out turned.
PointCloud sample_triangles(const TriangleMesh& mesh, double per_square_metre) {
  const float side = signed_volume(mesh) < 0 ? -1.0f : 1.0f;
  PointCloud cloud;
  RandomStream random(1);
  double carry = 0;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3f a = mesh.vertices[triangle[0]];
    const Eigen::Vector3f ab = mesh.vertices[triangle[1]] - a;
    const Eigen::Vector3f ac = mesh.vertices[triangle[2]] - a;
    const Eigen::Vector3f cross = ab.cross(ac);
    const double area = 0.5 * static_cast<double>(cross.norm());
    if (!(area > 0)) continue;
    carry += area * per_square_metre;
    for (; carry >= 1; carry -= 1) {
      auto s = static_cast<float>(random.uniform());
      auto t = static_cast<float>(random.uniform());
      if (s + t > 1) s = 1 - s, t = 1 - t;
      cloud.points.push_back(a + s * ab + t * ac);
      cloud.normals.push_back(side * cross.normalized());
      if (mesh.colors.empty()) continue;
      std::array<std::uint8_t, 3> color{};
      for (std::size_t k = 0; k < 3; ++k) {
        const float c0 = mesh.colors[triangle[0]][k];
        const float c1 = mesh.colors[triangle[1]][k];
        const float c2 = mesh.colors[triangle[2]][k];
        color[k] = static_cast<std::uint8_t>(c0 + s * (c1 - c0) + t * (c2 - c0));
      }
      cloud.colors.push_back(color);
    }
  }
  return cloud;
}

double surface_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3f a = mesh.vertices[triangle[0]];
    area +=
        0.5 * static_cast<double>(
                  (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a).norm());
  }
  return area;
}

// The largest distance of two points; exact over the extreme points of 200 directions.
double largest_distance(const std::vector<Eigen::Vector3f>& points) {
  std::vector<Eigen::Vector3f> extremes;
  const double golden_angle = M_PI * (3 - std::sqrt(5.0));
  for (int i = 0; i < 200; ++i) {
    const double z = 1 - (2 * i + 1.0) / 200;
    const double r = std::sqrt(1 - z * z);
    const Eigen::Vector3f direction(static_cast<float>(r * std::cos(golden_angle * i)),
                                    static_cast<float>(r * std::sin(golden_angle * i)),
                                    static_cast<float>(z));
    extremes.push_back(*std::max_element(points.begin(), points.end(), [&](auto& a, auto& b) {
      return a.dot(direction) < b.dot(direction);
    }));
  }
  double best = 0;
  for (const auto& a : extremes) {
    for (const auto& b : extremes) best = std::max(best, static_cast<double>((a - b).norm()));
  }
  return best;
}

Status check_size(const std::string& name, double diameter) {
  if (diameter >= kMinDiameter && diameter <= kMaxDiameter) return {};
  std::ostringstream text;
  text << "model " << name << " has a diameter of " << diameter
       << " m; it must be between 0.005 and 3 m";
  if (diameter > kMaxDiameter) text << " (a mesh in millimetres? try --scale 0.001)";
  if (diameter < kMinDiameter && diameter > 0) text << " (try --scale 1000)";
  return invalid_argument(text.str());
}

// Keeps what some view sees; turns normals that are only ever seen from behind (flipped faces). The
// inside of a thin wall lies so close to its outside that it seems to be seen from behind as well:
// being seen from the front at all decides.
PointCloud visible_surface(const PointCloud& cloud, float spacing, int num_threads) {
  PointCloud flipped = cloud;
  for (Eigen::Vector3f& normal : flipped.normals) normal = -normal;
  std::vector<int> front(cloud.size(), 0);
  std::vector<int> back(cloud.size(), 0);
  for (const ModelView& view : render_views(cloud, spacing, num_threads)) {
    for (std::uint32_t i : view.visible) ++front[i];
  }
  for (const ModelView& view : render_views(flipped, spacing, num_threads)) {
    for (std::uint32_t i : view.visible) ++back[i];
  }
  PointCloud out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (front[i] + back[i] == 0) continue;
    out.points.push_back(cloud.points[i]);
    out.normals.push_back(front[i] > 0 ? cloud.normals[i] : flipped.normals[i]);
    if (!cloud.colors.empty()) out.colors.push_back(cloud.colors[i]);
  }
  return out;
}

ModelSource make_source(PointCloud surface, const std::string& name, int number, int num_threads) {
  ModelSource source;
  source.name = name;
  source.number = number;
  source.diameter = largest_distance(surface.points);
  source.normal_variance = geometric_normal_variance(surface, num_threads);
  source.surface = std::move(surface);
  return source;
}

}  // namespace

Result<ModelSource> model_source_from_mesh(const TriangleMesh& mesh, const std::string& name,
                                           int number, const ModelOptions& options) {
  if (Status status = validate(options); !status.ok()) return status;
  const double area = surface_area(mesh);
  if (mesh.vertices.empty() || !(area > 0) || !std::isfinite(area)) {
    return invalid_argument("model " + name + " has no surface; the mesh must have triangles");
  }
  if (Status s = check_size(name, largest_distance(mesh.vertices)); !s.ok()) return s;
  // Small objects are sampled more finely, so that they too have about 2000 points.
  const double spacing = std::min(options.spacing_m, std::sqrt(area / 2000));
  const PointCloud dense = sample_triangles(mesh, 6 / (spacing * spacing));
  const PointCloud even = downsample(dense, static_cast<float>(spacing));
  return make_source(visible_surface(even, static_cast<float>(1.2 * spacing), options.num_threads),
                     name, number, options.num_threads);
}

Result<ModelSource> model_source_from_points(const PointCloud& cloud, const std::string& name,
                                             int number, const ModelOptions& options) {
  if (Status status = validate(options); !status.ok()) return status;
  if (cloud.size() < 100) {
    return invalid_argument("model " + name + " has " + std::to_string(cloud.size()) +
                            " points; it must have at least 100");
  }
  if (Status s = check_size(name, largest_distance(cloud.points)); !s.ok()) return s;
  const auto spacing = static_cast<float>(options.spacing_m);
  if (!cloud.normals.empty()) {
    return make_source(downsample(cloud, spacing), name, number, options.num_threads);
  }
  // One view of an object, in its camera's frame: normals point to the origin.
  PointCloud even = downsample(cloud, spacing);
  estimate_normals(even, 4 * spacing, Eigen::Vector3f::Zero(), options.num_threads);
  ModelSource source = make_source(std::move(even), name, number, options.num_threads);
  source.complete = false;
  return source;
}

}  // namespace bpa
