// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/depth_render.hpp"

#include <algorithm>
#include <cmath>

namespace bpa::eval {
namespace {

constexpr double kNearest = 0.01;

struct Vertex {
  Eigen::Vector2d pixel;
  double inverse_depth = 0;  // linear in the image; 0 where the vertex is too near
};

void draw_triangle(const Vertex& a, const Vertex& b, const Vertex& c, const Camera& camera,
                   std::vector<float>& depth) {
  const Eigen::Vector2d ab = b.pixel - a.pixel;
  const Eigen::Vector2d ac = c.pixel - a.pixel;
  const double area = ab.x() * ac.y() - ab.y() * ac.x();
  if (area == 0 || !std::isfinite(area)) return;
  const Eigen::Vector2d low = a.pixel.cwiseMin(b.pixel).cwiseMin(c.pixel);
  const Eigen::Vector2d high = a.pixel.cwiseMax(b.pixel).cwiseMax(c.pixel);
  const int left = static_cast<int>(std::ceil(std::max(low.x(), 0.0)));
  const int right = static_cast<int>(std::floor(std::min(high.x(), camera.width - 1.0)));
  const int top = static_cast<int>(std::ceil(std::max(low.y(), 0.0)));
  const int bottom = static_cast<int>(std::floor(std::min(high.y(), camera.height - 1.0)));
  for (int v = top; v <= bottom; ++v) {
    for (int u = left; u <= right; ++u) {
      const Eigen::Vector2d p = Eigen::Vector2d(u, v) - a.pixel;
      const double wb = (p.x() * ac.y() - p.y() * ac.x()) / area;
      const double wc = (ab.x() * p.y() - ab.y() * p.x()) / area;
      if (wb < 0 || wc < 0 || wb + wc > 1) continue;
      const double inverse =
          (1 - wb - wc) * a.inverse_depth + wb * b.inverse_depth + wc * c.inverse_depth;
      float& z = depth[v * camera.width + u];
      const auto here = static_cast<float>(1 / inverse);
      if (z == 0 || here < z) z = here;
    }
  }
}

}  // namespace

std::vector<float> render_depth(const TriangleMesh& mesh, const Pose& camera_from_object,
                                const Camera& camera) {
  std::vector<float> depth(camera.width * camera.height, 0.0f);
  std::vector<Vertex> vertices;
  const Eigen::Matrix3d rotation = camera_from_object.matrix();
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    const Eigen::Vector3d p = rotation * vertex.cast<double>() + camera_from_object.translation;
    vertices.push_back(p.z() > kNearest ? Vertex{camera.project(p), 1 / p.z()} : Vertex{});
  }
  for (const auto& triangle : mesh.triangles) {
    const Vertex& a = vertices[triangle[0]];
    const Vertex& b = vertices[triangle[1]];
    const Vertex& c = vertices[triangle[2]];
    const bool visible = a.inverse_depth > 0 && b.inverse_depth > 0 && c.inverse_depth > 0;
    if (visible) draw_triangle(a, b, c, camera, depth);
  }
  return depth;
}

}  // namespace bpa::eval
