// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Each direction has an orthographic image of the mesh in which every pixel knows the triangle seen
// at its centre. A point is compared with the plane of that triangle right where the point is, not
// at the pixel's centre, so that the size of pixels hardly matters.
#include "core/modeling/mesh_visibility.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "core/base/parallel.hpp"
#include "core/geometry/sphere_directions.hpp"

namespace bpa {
namespace {

constexpr float kGrazing = 0.26f;       // sine of 15 degrees
constexpr float kTolerance = 0.00001f;  // metres

// The mesh as seen along one direction: x and y in the image plane, z toward the viewer.
class TriangleImage {
 public:
  TriangleImage(const std::vector<Eigen::Vector3f>& vertices, const TriangleMesh& mesh, float pixel)
      : vertices_(vertices), mesh_(mesh), pixel_(pixel) {
    low_ = high_ = vertices.front().head<2>();
    for (const Eigen::Vector3f& v : vertices) {
      low_ = low_.cwiseMin(v.head<2>());
      high_ = high_.cwiseMax(v.head<2>());
    }
    width_ = static_cast<int>((high_.x() - low_.x()) / pixel) + 1;
    height_ = static_cast<int>((high_.y() - low_.y()) / pixel) + 1;
    const auto count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    nearest_.assign(count, -std::numeric_limits<float>::infinity());
    triangle_.assign(count, -1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) draw(static_cast<std::int32_t>(t));
  }

  bool hides(const Eigen::Vector3f& p, std::uint32_t own) const {
    const int x = static_cast<int>((p.x() - low_.x()) / pixel_);
    const int y = static_cast<int>((p.y() - low_.y()) / pixel_);
    float farthest = std::numeric_limits<float>::infinity();
    std::int32_t last = static_cast<std::int32_t>(own);
    for (int v = std::max(0, y - 1); v <= std::min(height_ - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(width_ - 1, x + 1); ++u) {
        const auto i = static_cast<std::size_t>(v * width_ + u);
        farthest = std::min(farthest, nearest_[i]);
        if (triangle_[i] == last) continue;
        last = triangle_[i];
        if (last >= 0 && last != static_cast<std::int32_t>(own) && covers(last, p)) return true;
      }
    }
    // Triangles smaller than pixels are not all in the image, but where the whole neighbourhood is
    // covered, so is the point.
    return farthest > p.z() + 4 * pixel_;
  }

 private:
  // Whether a triangle lies above p.
  bool covers(std::int32_t t, const Eigen::Vector3f& p) const {
    const auto& corners = mesh_.triangles[static_cast<std::size_t>(t)];
    const Eigen::Vector3f& a = vertices_[corners[0]];
    const Eigen::Vector3f ab = vertices_[corners[1]] - a, ac = vertices_[corners[2]] - a;
    const Eigen::Vector3f ap = p - a;
    const float area = ab.x() * ac.y() - ab.y() * ac.x();
    if (std::abs(area) < 1e-14f) return false;
    const float wb = (ap.x() * ac.y() - ap.y() * ac.x()) / area;
    const float wc = (ab.x() * ap.y() - ab.y() * ap.x()) / area;
    constexpr float kSlack = 1e-3f;
    return wb >= -kSlack && wc >= -kSlack && wb + wc <= 1 + kSlack &&
           wb * ab.z() + wc * ac.z() > ap.z() + kTolerance;
  }

  void draw(std::int32_t t) {
    const auto& corners = mesh_.triangles[static_cast<std::size_t>(t)];
    const Eigen::Vector3f &a = vertices_[corners[0]], &b = vertices_[corners[1]],
                          &c = vertices_[corners[2]];
    const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (std::abs(area) < 1e-14f) return;
    const auto range = [&](int axis, int size, int& first, int& last) {
      const auto [least, most] = std::minmax({a[axis], b[axis], c[axis]});
      first = std::max(0, static_cast<int>(std::ceil((least - low_[axis]) / pixel_ - 0.5f)));
      last = std::min(size - 1, static_cast<int>(std::floor((most - low_[axis]) / pixel_ - 0.5f)));
    };
    int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
    range(0, width_, x0, x1);
    range(1, height_, y0, y1);
    for (int y = y0; y <= y1; ++y) {
      const float py = low_.y() + (static_cast<float>(y) + 0.5f) * pixel_;
      for (int x = x0; x <= x1; ++x) {
        const float px = low_.x() + (static_cast<float>(x) + 0.5f) * pixel_;
        const float wb = ((px - a.x()) * (c.y() - a.y()) - (py - a.y()) * (c.x() - a.x())) / area;
        const float wc = ((b.x() - a.x()) * (py - a.y()) - (b.y() - a.y()) * (px - a.x())) / area;
        if (wb < 0 || wc < 0 || wb + wc > 1) continue;
        const float z = a.z() + wb * (b.z() - a.z()) + wc * (c.z() - a.z());
        const auto i = static_cast<std::size_t>(y * width_ + x);
        if (z <= nearest_[i]) continue;
        nearest_[i] = z;
        triangle_[i] = t;
      }
    }
  }

  const std::vector<Eigen::Vector3f>& vertices_;
  const TriangleMesh& mesh_;
  float pixel_;
  Eigen::Vector2f low_, high_;
  int width_ = 0, height_ = 0;
  std::vector<float> nearest_;
  std::vector<std::int32_t> triangle_;
};

std::vector<Eigen::Matrix3f> view_frames() {
  std::vector<Eigen::Matrix3f> frames;
  for (int i = 0; i < kNumSeenFrom; ++i) {
    const Eigen::Vector3f d = sphere_direction(i, kNumSeenFrom).cast<float>();
    Eigen::Matrix3f frame;
    frame.row(2) = d;
    frame.row(0) = d.unitOrthogonal();
    frame.row(1) = d.cross(Eigen::Vector3f(frame.row(0)));
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace

std::vector<SidesSeen> sides_seen(const TriangleMesh& mesh, const std::vector<MeshPoint>& points,
                                  int num_threads) {
  std::vector<SidesSeen> seen(points.size());
  if (mesh.vertices.empty()) return seen;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& v : mesh.vertices) box.extend(v);
  const float pixel = std::max(1e-4f, box.diagonal().norm() / 240);
  std::vector<Eigen::Vector3f> normals(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& t = mesh.triangles[points[i].triangle];
    const Eigen::Vector3f a = mesh.vertices[t[0]];
    normals[i] = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).normalized();
  }
  const std::vector<Eigen::Matrix3f> frames = view_frames();
  std::mutex mutex;  // counts are added up; the order does not matter
  parallel_for(kNumSeenFrom, num_threads, [&](int k) {
    const Eigen::Matrix3f& frame = frames[static_cast<std::size_t>(k)];
    std::vector<Eigen::Vector3f> turned(mesh.vertices.size());
    for (std::size_t v = 0; v < turned.size(); ++v) turned[v] = frame * mesh.vertices[v];
    const TriangleImage image(turned, mesh, pixel);
    std::vector<std::uint32_t> visible;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::abs(normals[i].dot(frame.row(2))) < kGrazing) continue;
      if (!image.hides(frame * points[i].point, points[i].triangle)) {
        visible.push_back(static_cast<std::uint32_t>(i));
      }
    }
    const std::lock_guard lock(mutex);
    for (const std::uint32_t i : visible) {
      (normals[i].dot(frame.row(2)) > 0 ? seen[i].front : seen[i].back) += 1;
    }
  });
  return seen;
}

}  // namespace bpa
