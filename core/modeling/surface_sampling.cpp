// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/cloud/join_vertices.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/cloud/texture.hpp"
#include "core/geometry/sphere_directions.hpp"
#include "core/model/view_sphere.hpp"
#include "core/modeling/private/surface_source.hpp"

namespace bpa::modeling {
namespace {

constexpr double kMinDiameter = 0.005;
constexpr double kMaxDiameter = 3.0;
constexpr double kFewPoints = 2000;
constexpr std::size_t kMostTriangles = 1'500'000;  // all are drawn for each direction
constexpr std::size_t kMostVertices = 1'000'000;   // closed surfaces have half as many
// Of the squared length: a ball has 1, a close stack of 15 plates 15. Pixels drawn and samples
// beside one another grow with it.
constexpr double kMostArea = 30;

// Points of the surface of a mesh, and the triangles that they lie on.
struct Samples {
  PointCloud cloud;
  std::vector<std::uint32_t> triangles;
};

// Points away from the front of a triangle; twice its area long.
Eigen::Vector3f cross_of(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
}

// Points on the triangles, `per_square_metre` on average, with the triangles' normals.
Samples sample_triangles(const TriangleMesh& mesh, double per_square_metre) {
  Samples samples;
  RandomStream random(1);
  const bool colored = has_colors(mesh);
  const auto side = static_cast<float>(1 / std::sqrt(per_square_metre));  // of a sample's square
  double carry = 0;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const auto& [first, second, third] = mesh.triangles[k];
    const Eigen::Vector3f a = mesh.vertices[first];
    const Eigen::Vector3f ab = mesh.vertices[second] - a, ac = mesh.vertices[third] - a;
    const Eigen::Vector3f cross = cross_of(mesh, k);
    const double area = 0.5 * cross.norm();
    if (!(area > 0)) continue;
    carry += area * per_square_metre;
    for (; carry >= 1; carry -= 1) {
      auto s = static_cast<float>(random.uniform());
      auto t = static_cast<float>(random.uniform());
      if (s + t > 1) s = 1 - s, t = 1 - t;
      samples.cloud.points.push_back(a + s * ab + t * ac);
      samples.cloud.normals.push_back(cross.normalized());
      samples.triangles.push_back(k);
      if (!colored) continue;
      const Eigen::Vector3f color = color_at(mesh, k, {s, t}, side);
      samples.cloud.colors.push_back({static_cast<std::uint8_t>(color[0]),
                                      static_cast<std::uint8_t>(color[1]),
                                      static_cast<std::uint8_t>(color[2])});
    }
  }
  return samples;
}

// Visibility. Each direction has an orthographic image of the mesh in which every pixel knows the
// triangle seen at its centre. A point is compared with the plane of that triangle right where the
// point is, not at the pixel's centre, so that the size of pixels hardly matters.
constexpr int kNumSeenFrom = 120;       // directions, spread evenly over the sphere
constexpr float kGrazing = 0.26f;       // sine of 15 degrees
constexpr float kTolerance = 0.00001f;  // metres

// A triangle as seen along z: a corner, and the sides from there to the others.
struct SeenTriangle {
  Eigen::Vector3f corner, second, third;

  float area() const { return second.x() * third.y() - second.y() * third.x(); }  // times two
  // The barycentric weights of the other two corners.
  Eigen::Vector2f weights(float x, float y) const {
    const float u = x - corner.x(), v = y - corner.y();
    return {(u * third.y() - v * third.x()) / area(), (second.x() * v - second.y() * u) / area()};
  }
  bool flat() const { return std::abs(area()) < 1e-14f; }
};

// The mesh as seen along one direction: x and y in the image plane, z toward the viewer.
class TriangleImage {
 public:
  TriangleImage(const std::vector<Eigen::Vector3f>& vertices, const TriangleMesh& mesh, float pixel)
      : vertices_(vertices), mesh_(mesh), pixel_(pixel) {
    Eigen::AlignedBox2f box;
    for (const Eigen::Vector3f& v : vertices) box.extend(v.head<2>());
    low_ = box.min();
    width_ = static_cast<int>(box.sizes().x() / pixel) + 1;
    height_ = static_cast<int>(box.sizes().y() / pixel) + 1;
    nearest_.assign(width_ * height_, -std::numeric_limits<float>::infinity());
    triangle_.assign(width_ * height_, -1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) draw(t);
  }

  // Whether triangles hide a point that lies on triangle `own`.
  bool hides(const Eigen::Vector3f& p, int own) const {
    const int x = static_cast<int>((p.x() - low_.x()) / pixel_);
    const int y = static_cast<int>((p.y() - low_.y()) / pixel_);
    float farthest = std::numeric_limits<float>::infinity();
    const auto for_each_pixel = [&](const auto& visit) {
      for (int v = std::max(0, y - 1); v <= std::min(height_ - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(width_ - 1, x + 1); ++u) {
          visit(v * width_ + u);
        }
      }
    };
    for_each_pixel([&](int i) { farthest = std::min(farthest, nearest_[i]); });
    // Triangles smaller than pixels may be missing in the image, but where it is covered, so is p.
    if (farthest > p.z() + 4 * pixel_) return true;
    int last = own;
    bool hidden = false;
    for_each_pixel([&](int i) {
      if (hidden || triangle_[i] == last) return;
      last = triangle_[i];
      hidden = last >= 0 && last != own && covers(last, p);
    });
    return hidden;
  }

 private:
  SeenTriangle seen(int triangle) const {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    return {vertices_[a], vertices_[b] - vertices_[a], vertices_[c] - vertices_[a]};
  }

  // Whether a triangle lies above p.
  bool covers(int triangle, const Eigen::Vector3f& p) const {
    const SeenTriangle t = seen(triangle);
    if (t.flat()) return false;
    const Eigen::Vector2f w = t.weights(p.x(), p.y());
    constexpr float kSlack = 1e-3f;
    return w.x() >= -kSlack && w.y() >= -kSlack && w.x() + w.y() <= 1 + kSlack &&
           w.x() * t.second.z() + w.y() * t.third.z() > p.z() - t.corner.z() + kTolerance;
  }

  void draw(int triangle) {
    const SeenTriangle t = seen(triangle);
    if (t.flat()) return;
    Eigen::AlignedBox2f box;
    for (const std::uint32_t c : mesh_.triangles[triangle]) box.extend(vertices_[c].head<2>());
    const Eigen::Array2f from = (box.min() - low_) / pixel_, to = (box.max() - low_) / pixel_;
    const Eigen::Array2i first = (from - 0.5f).ceil().cast<int>().max(0);
    const Eigen::Array2i last =
        (to - 0.5f).floor().cast<int>().min(Eigen::Array2i(width_ - 1, height_ - 1));
    for (int y = first.y(); y <= last.y(); ++y) {
      for (int x = first.x(); x <= last.x(); ++x) {
        const Eigen::Vector2f w =
            t.weights(low_.x() + (x + 0.5f) * pixel_, low_.y() + (y + 0.5f) * pixel_);
        if (w.x() < 0 || w.y() < 0 || w.x() + w.y() > 1) continue;
        const float z = t.corner.z() + w.x() * t.second.z() + w.y() * t.third.z();
        const int i = y * width_ + x;
        if (z <= nearest_[i]) continue;
        nearest_[i] = z;
        triangle_[i] = triangle;
      }
    }
  }

  const std::vector<Eigen::Vector3f>& vertices_;
  const TriangleMesh& mesh_;
  float pixel_;
  Eigen::Vector2f low_;
  int width_ = 0, height_ = 0;
  std::vector<float> nearest_;
  std::vector<int> triangle_;
};

// How many directions see a point of a mesh, or whether any does: before and behind its triangle.
struct Sides {
  int front = 0, back = 0;
};

// Looks at the mesh from kNumSeenFrom directions far away: which of the samples are not hidden by
// its triangles. Exact but for kTolerance, so that the two sides of a thin wall are told apart;
// directions that graze a sample's tangent plane do not count.
std::vector<Sides> sides_seen(const TriangleMesh& mesh, const Samples& samples, int num_threads) {
  const PointCloud& cloud = samples.cloud;
  std::vector<Sides> seen(cloud.size());
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& v : mesh.vertices) box.extend(v);
  const float pixel = std::max(1e-4f, box.diagonal().norm() / 240);
  std::mutex mutex;  // counts are added up; the order does not matter
  parallel_for(kNumSeenFrom, num_threads, [&](int k) {
    const Eigen::Matrix3f axes = view_axes(sphere_direction(k, kNumSeenFrom).cast<float>());
    std::vector<Eigen::Vector3f> turned;
    turned.reserve(mesh.vertices.size());
    for (const Eigen::Vector3f& v : mesh.vertices) turned.push_back(axes * v);
    const TriangleImage image(turned, mesh, pixel);
    std::vector<std::size_t> visible;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (std::abs(cloud.normals[i].dot(axes.row(2))) < kGrazing) continue;
      if (!image.hides(axes * cloud.points[i], samples.triangles[i])) visible.push_back(i);
    }
    const std::lock_guard lock(mutex);
    for (const std::size_t i : visible) {
      (cloud.normals[i].dot(axes.row(2)) > 0 ? seen[i].front : seen[i].back) += 1;
    }
  });
  return seen;
}
// What a camera outside can see of the samples, each side of a sheet for itself; how many normals
// were turned, and how many samples lie inside.
struct VisibleSurface {
  PointCloud cloud;
  std::size_t flipped = 0, hidden = 0, two_sided = 0;
};

Sides decide(const Sides& seen) {
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
  parallel_for(sides.size(), num_threads, [&](std::size_t i) {
    const Eigen::Vector3f& normal = cloud.normals[i];
    int front = 0, back = 0, all = 0;
    grid.for_each_neighbor(cloud.points[i], [&](int j, float) {
      const float cosine = normal.dot(cloud.normals[j]);
      const float off = normal.dot(cloud.points[j] - cloud.points[i]);
      if (std::abs(cosine) < 0.9f || std::abs(off) > kSameSurface) return;
      front += cosine > 0 ? sides[j].front : sides[j].back;
      back += cosine > 0 ? sides[j].back : sides[j].front;
      ++all;
    });
    out[i] = {sides[i].front && 2 * front > all, sides[i].back && 2 * back > all};
  });
  return out;
}

VisibleSurface visible_surface(const TriangleMesh& mesh, const Samples& samples, float spacing,
                               int num_threads) {
  std::vector<Sides> sides = sides_seen(mesh, samples, num_threads);
  std::ranges::transform(sides, sides.begin(), decide);
  sides = confirmed(samples.cloud, spacing, sides, num_threads);
  VisibleSurface out;
  std::vector<int> shown;
  std::vector<float> sign;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const auto [front, back] = sides[i];
    shown.insert(shown.end(), front + back, i);
    if (front) sign.push_back(1);
    if (back) sign.push_back(-1);
    out.hidden += !front && !back;
    out.flipped += back && !front;
    out.two_sided += front && back;
  }
  out.cloud = select(samples.cloud, shown);
  for (std::size_t i = 0; i < sign.size(); ++i) out.cloud.normals[i] *= sign[i];
  return out;
}

// What people should know about the mesh.
std::vector<std::string> mesh_warnings(const VisibleSurface& visible, std::size_t samples) {
  constexpr double kMany = 0.02;
  std::vector<std::string> warnings;
  const auto warn = [&](std::size_t count, const char* text) {
    const double share = static_cast<double>(count) / samples;
    if (share < kMany) return;
    warnings.push_back(std::to_string(std::lround(100 * share)) + " % of the mesh " + text);
  };
  warn(visible.flipped, "faced inwards and was turned over");
  warn(visible.two_sided,
       "is seen from both sides (an open mesh): both are part of the model, without thickness");
  warn(visible.hidden, "lies inside, where nothing sees it, and was left out");
  return warnings;
}

}  // namespace

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

std::string coarse_warning(double spacing) {
  return concat("is so large that its points are ", fixed(1000 * spacing, 1), " mm apart");
}

Status check_size(const std::string& name, double diameter) {
  if (diameter >= kMinDiameter && diameter <= kMaxDiameter) return {};
  return invalid_argument(
      "model ", name, " has a diameter of ", diameter,
      " m; it must be between 0.005 and 3 m. If its unit is another, say it (--unit mm, cm, m or "
      "in, or --scale)");
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
  if (mesh.triangles.size() > kMostTriangles) {
    return invalid_argument("model ", name, " has ", mesh.triangles.size(),
                            " triangles; it must have at most ", kMostTriangles,
                            ": simplify the mesh (MeshLab: Quadric Edge Collapse Decimation)");
  }
  double area = 0;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) area += 0.5 * cross_of(mesh, k).norm();
  if (mesh.vertices.empty() || !(area > 0) || !std::isfinite(area)) {
    return invalid_argument("model " + name + " has no surface; the mesh must have triangles");
  }
  const TriangleMesh shape = shape_of(mesh);
  if (shape.vertices.size() > kMostVertices) {
    return invalid_argument("model ", name, " has ", shape.vertices.size(),
                            " vertices; it must have at most ", kMostVertices,
                            ": join them (MeshLab: Merge Close Vertices)");
  }
  const double length = largest_distance(shape.vertices);
  if (Status s = check_size(name, length); !s.ok()) return s;
  if (area > kMostArea * length * length) {
    return invalid_argument("model ", name, " has ", fixed(area, 2), " m2 of faces within ",
                            fixed(length, 3),
                            " m: they lie over each other in many layers; remove ",
                            "the copies (MeshLab: Merge Close Vertices, Remove Duplicate Faces)");
  }
  // Small objects are sampled more finely, so that they too have some points; large ones coarsely.
  const double spacing = std::max(std::min(options.spacing_m, std::sqrt(area / kFewPoints)),
                                  std::sqrt(area / kMostPoints));
  const Samples samples = sample_triangles(mesh, 6 / (spacing * spacing));
  const VisibleSurface visible = visible_surface(shape, samples, spacing, options.num_threads);
  if (visible.cloud.size() < 100) {
    return invalid_argument("model " + name + " has no surface that can be seen from outside");
  }
  ModelSource source =
      make_source(downsample(visible.cloud, spacing), name, number, options.num_threads);
  std::ranges::move(mesh_warnings(visible, samples.triangles.size()),
                    std::back_inserter(source.warnings));
  if (spacing > options.spacing_m) source.warnings.push_back(coarse_warning(spacing));
  return source;
}

}  // namespace bpa::modeling
