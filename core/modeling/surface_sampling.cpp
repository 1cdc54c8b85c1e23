// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/cloud/curvature.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/geometry/sphere_directions.hpp"
#include "core/modeling/mesh_visibility.hpp"
#include "core/modeling/model_source.hpp"

namespace bpa {
namespace {

constexpr double kMinDiameter = 0.005;
constexpr double kMaxDiameter = 3.0;

struct Samples {
  PointCloud cloud;
  std::vector<MeshPoint> places;
};

// Points on the triangles, `per_square_metre` on average, with the triangles' normals.
Samples sample_triangles(const TriangleMesh& mesh, double per_square_metre) {
  Samples samples;
  RandomStream random(1);
  double carry = 0;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const auto& triangle = mesh.triangles[k];
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
      samples.cloud.points.push_back(a + s * ab + t * ac);
      samples.cloud.normals.push_back(cross.normalized());
      samples.places.push_back({samples.cloud.points.back(), static_cast<std::uint32_t>(k)});
      if (mesh.colors.empty()) continue;
      std::array<std::uint8_t, 3> color{};
      for (std::size_t c = 0; c < 3; ++c) {
        const float c0 = mesh.colors[triangle[0]][c];
        const float c1 = mesh.colors[triangle[1]][c];
        const float c2 = mesh.colors[triangle[2]][c];
        color[c] = static_cast<std::uint8_t>(c0 + s * (c1 - c0) + t * (c2 - c0));
      }
      samples.cloud.colors.push_back(color);
    }
  }
  return samples;
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

// What a camera outside can see of the samples, each side of a sheet for itself; how many normals
// were turned, and how many samples lie inside.
struct VisibleSurface {
  PointCloud cloud;
  std::size_t flipped = 0, hidden = 0, two_sided = 0;
};

struct Sides {
  bool front = false, back = false;
};

Sides decide(const SidesSeen& seen) {
  // A few glances through a crack do not make a surface, nor do they turn one over.
  constexpr int kGlance = kNumSeenFrom / 40;
  const auto counts = [](int here, int other) {
    return here > 0 && 4 * here > other && (here > kGlance || other <= kGlance);
  };
  const bool front = counts(seen.front, seen.back);
  return {front, counts(seen.back, seen.front) && (seen.back > kGlance || !front)};
}

// Right at the edge of a solid both sides of a face seem to be seen. A surface is wider than that:
// a side is kept where a good part of the same surface round it is seen from that side too.
std::vector<Sides> confirmed(const PointCloud& cloud, float radius, const std::vector<Sides>& sides,
                             int num_threads) {
  constexpr float kSameSurface = 0.0004f;  // metres off the tangent plane
  const NeighborGrid grid(cloud.points, radius);
  std::vector<Sides> out(sides.size());
  parallel_for(
      static_cast<int>(sides.size()), num_threads,
      [&](int index) {
        const auto i = static_cast<std::size_t>(index);
        const Eigen::Vector3f& normal = cloud.normals[i];
        int front = 0, back = 0, all = 0;
        grid.for_each_neighbor(cloud.points[i], [&](int neighbour, float) {
          const auto j = static_cast<std::size_t>(neighbour);
          const float cosine = normal.dot(cloud.normals[j]);
          const float off = normal.dot(cloud.points[j] - cloud.points[i]);
          if (std::abs(cosine) < 0.9f || std::abs(off) > kSameSurface) return;
          front += cosine > 0 ? sides[j].front : sides[j].back;
          back += cosine > 0 ? sides[j].back : sides[j].front;
          ++all;
        });
        out[i] = {sides[i].front && 2 * front > all, sides[i].back && 2 * back > all};
      },
      256);
  return out;
}

VisibleSurface visible_surface(const TriangleMesh& mesh, const Samples& samples, float spacing,
                               int num_threads) {
  std::vector<Sides> sides;
  for (const SidesSeen& seen : sides_seen(mesh, samples.places, num_threads)) {
    sides.push_back(decide(seen));
  }
  sides = confirmed(samples.cloud, spacing, sides, num_threads);
  VisibleSurface out;
  const auto add = [&](std::size_t i, float side) {
    out.cloud.points.push_back(samples.cloud.points[i]);
    out.cloud.normals.push_back(side * samples.cloud.normals[i]);
    if (!samples.cloud.colors.empty()) out.cloud.colors.push_back(samples.cloud.colors[i]);
  };
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (sides[i].front) add(i, 1);
    if (sides[i].back) add(i, -1);
    out.hidden += !sides[i].front && !sides[i].back;
    out.flipped += sides[i].back && !sides[i].front;
    out.two_sided += sides[i].front && sides[i].back;
  }
  return out;
}

// What people should know about the mesh.
std::vector<std::string> mesh_warnings(const VisibleSurface& visible, std::size_t samples) {
  constexpr double kMany = 0.02;
  std::vector<std::string> warnings;
  const auto warn = [&](std::size_t count, const char* text) {
    const double share = static_cast<double>(count) / static_cast<double>(samples);
    if (share < kMany) return;
    warnings.push_back(std::to_string(std::lround(100 * share)) + " % of the mesh " + text);
  };
  warn(visible.flipped, "faced inwards and was turned over");
  warn(visible.two_sided,
       "is seen from both sides (an open mesh): both are part of the model, without thickness");
  warn(visible.hidden, "lies inside, where nothing sees it, and was left out");
  return warnings;
}

ModelSource make_source(PointCloud surface, const std::string& name, int number, int num_threads) {
  ModelSource source;
  source.name = name;
  source.number = number;
  source.diameter = largest_distance(surface.points);
  source.normal_variance = geometric_normal_variance(surface, num_threads);
  source.warnings = shape_warnings(surface);
  source.surface = std::move(surface);
  return source;
}

}  // namespace

double largest_distance(const std::vector<Eigen::Vector3f>& points) {
  constexpr int kDirections = 200;
  std::vector<Eigen::Vector3f> extremes;
  for (int i = 0; i < kDirections; ++i) {
    const Eigen::Vector3f direction = sphere_direction(i, kDirections).cast<float>();
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

std::vector<std::string> shape_warnings(const PointCloud& surface) {
  constexpr float kFlat = 0.99f;  // share of the squared normals along one axis
  Eigen::Matrix3f scatter = Eigen::Matrix3f::Zero();
  for (const Eigen::Vector3f& n : surface.normals) scatter += n * n.transpose();
  scatter /= static_cast<float>(std::max<std::size_t>(1, surface.normals.size()));
  const float most = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>(scatter).eigenvalues()[2];
  if (surface.normals.empty() || most < kFlat) return {};
  return {
      "is one flat face: only its outline tells where it lies in its plane, and every table looks "
      "like it"};
}

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
  const Samples samples = sample_triangles(mesh, 6 / (spacing * spacing));
  VisibleSurface visible =
      visible_surface(mesh, samples, static_cast<float>(spacing), options.num_threads);
  if (visible.cloud.size() < 100) {
    return invalid_argument("model " + name + " has no surface that can be seen from outside");
  }
  ModelSource source = make_source(downsample(visible.cloud, static_cast<float>(spacing)), name,
                                   number, options.num_threads);
  for (std::string& warning : mesh_warnings(visible, samples.places.size())) {
    source.warnings.push_back(std::move(warning));
  }
  return source;
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
