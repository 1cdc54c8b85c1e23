// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/view_sphere.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.hpp"
#include "core/geometry/sphere_directions.hpp"
#include "core/model/distance_transform.hpp"

namespace bpa {
namespace {

constexpr float kNothing = -std::numeric_limits<float>::infinity();
constexpr float kDrop = 0.012f;  // a step that a Kinect-class sensor shows as a range edge

// An orthographic depth buffer: larger is nearer to the camera.
struct DepthBuffer {
  int width = 0;
  int height = 0;
  float cell = 1;
  Eigen::Vector2f origin = Eigen::Vector2f::Zero();
  std::vector<float> nearest;

  int column(float x) const { return static_cast<int>((x - origin.x()) / cell); }
  int row(float y) const { return static_cast<int>((y - origin.y()) / cell); }
  std::size_t cell_of(const Eigen::Vector3f& p) const { return row(p.y()) * width + column(p.x()); }
  float at(int x, int y) const {
    if (x < 0 || y < 0 || x >= width || y >= height) return kNothing;
    return nearest[y * width + x];
  }
  // Calls visit(dx, dy) for the cells within the root of `squared_reach` of a point's, where the
  // surface is farther from the camera than `limit`.
  void for_each_behind(const Eigen::Vector3f& p, int squared_reach, float limit,
                       const auto& visit) const {
    const int x = column(p.x()), y = row(p.y()), reach = static_cast<int>(std::sqrt(squared_reach));
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        if (dx * dx + dy * dy > squared_reach) continue;
        if (at(x + dx, y + dy) < limit) visit(dx, dy);
      }
    }
  }
};

// Each point covers the 3x3 cells about it, so that the surface has no holes.
DepthBuffer draw(const std::vector<Eigen::Vector3f>& points, float cell) {
  DepthBuffer buffer;
  buffer.cell = cell;
  Eigen::AlignedBox2f box;
  for (const Eigen::Vector3f& p : points) box.extend(p.head<2>());
  buffer.origin = box.min().array() - 2 * cell;
  buffer.width = buffer.column(box.max().x()) + 3;
  buffer.height = buffer.row(box.max().y()) + 3;
  buffer.nearest.assign(buffer.width * buffer.height, kNothing);
  for (const Eigen::Vector3f& p : points) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        float& value = buffer.nearest[buffer.cell_of(p) + dy * buffer.width + dx];
        value = std::max(value, p.z());
      }
    }
  }
  return buffer;
}

// The direction in the view plane in which the surface ends within three cells; zero if none.
Eigen::Vector2f edge_direction(const DepthBuffer& buffer, const Eigen::Vector3f& p, float drop) {
  Eigen::Vector2f outward = Eigen::Vector2f::Zero();
  buffer.for_each_behind(p, 9, p.z() - drop,
                         [&](int dx, int dy) { outward += Eigen::Vector2f(dx, dy); });
  return outward;
}

// How far points are from the nearest range edge of the buffer, in the view plane.
class EdgeDistance {
 public:
  EdgeDistance(const DepthBuffer& buffer, const std::vector<Eigen::Vector3f>& points,
               const std::vector<std::uint32_t>& visible)
      : buffer_(buffer), edge_(buffer.nearest.size(), Eigen::Vector2f::Zero()) {
    std::vector<float> count(buffer.nearest.size(), 0);
    for (const std::uint32_t i : visible) {
      const Eigen::Vector3f& p = points[i];
      if (!ends_beside(p)) continue;
      const std::size_t cell = buffer.cell_of(p);
      edge_[cell] += p.head<2>();
      ++count[cell];
    }
    std::vector<std::uint8_t> marked(count.size());
    for (std::size_t i = 0; i < count.size(); ++i) {
      marked[i] = count[i] > 0;
      if (marked[i]) edge_[i] /= count[i];
    }
    nearest_ = nearest_marked_cells(marked, {buffer.width, buffer.height, 1});
  }

  float operator()(const Eigen::Vector3f& p) const {
    const std::int32_t cell = nearest_[buffer_.cell_of(p)];
    if (cell < 0) return kMaxEdgeDistance;
    return std::min(kMaxEdgeDistance, (edge_[cell] - p.head<2>()).norm());
  }

 private:
  // Whether the surface on which p lies ends in p's cell: draw() covers one cell more.
  bool ends_beside(const Eigen::Vector3f& p) const {
    bool ends = false;
    buffer_.for_each_behind(p, 5, p.z() - kDrop - 2 * buffer_.cell, [&](int, int) { ends = true; });
    return ends;
  }

  const DepthBuffer& buffer_;
  std::vector<Eigen::Vector2f> edge_;  // where the edge is in a cell that has one
  std::vector<std::int32_t> nearest_;
};

// Points in the view plane of a camera, z toward it, with the cosine between normal and line of
// sight.
struct SeenPoints {
  std::vector<Eigen::Vector3f> points;
  std::vector<float> cosine;
};

ModelView render_view(const SeenPoints& all, const Eigen::Matrix3f& axes, float spacing) {
  const std::vector<Eigen::Vector3f>& seen = all.points;
  std::vector<std::uint32_t> visible, edges;
  std::vector<float> edge_distance;
  std::vector<Eigen::Vector3f> outward_of;  // the edges
  const DepthBuffer buffer = draw(seen, spacing);
  const auto slope_of = [](float cosine) {
    return std::min(4.0f, std::sqrt(1 - cosine * cosine) / cosine);
  };
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const float cosine = all.cosine[i];
    if (cosine <= 0.05f) continue;
    const float nearest = buffer.nearest[buffer.cell_of(seen[i])];
    if (seen[i].z() < nearest - spacing * (1 + 2 * slope_of(cosine))) continue;
    visible.push_back(i);
  }
  const EdgeDistance distance_of(buffer, seen, visible);
  for (const std::uint32_t i : visible) {
    edge_distance.push_back(distance_of(seen[i]));
    const float slope = slope_of(all.cosine[i]);
    const Eigen::Vector2f outward = edge_direction(buffer, seen[i], kDrop + 1.5f * spacing * slope);
    if (outward.squaredNorm() < 4) continue;
    edges.push_back(i);
    const Eigen::Vector2f unit = outward.normalized();
    outward_of.push_back(axes.transpose() * Eigen::Vector3f(unit.x(), unit.y(), 0));
  }
  return {axes.row(2), std::move(visible), std::move(edge_distance), std::move(edges),
          std::move(outward_of)};
}

float cosine_of(const PointCloud& surface, std::size_t i, const Eigen::Vector3f& to_camera) {
  return surface.normals.empty() ? 1.0f : surface.normals[i].dot(to_camera);
}

ModelView render_from_afar(const PointCloud& surface, const Eigen::Vector3f& direction,
                           float spacing) {
  const Eigen::Matrix3f axes = view_axes(direction);
  SeenPoints seen;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    seen.points.push_back(axes * surface.points[i]);
    seen.cosine.push_back(cosine_of(surface, i, direction));
  }
  return render_view(seen, axes, spacing);
}

}  // namespace

Eigen::Matrix3f view_axes(const Eigen::Vector3f& direction) {
  Eigen::Matrix3f axes;
  axes.row(0) = direction.unitOrthogonal();
  axes.row(1) = direction.cross(Eigen::Vector3f(axes.row(0)));
  axes.row(2) = direction;
  return axes;
}

ModelView render_from(const PointCloud& surface, const Eigen::Vector3f& camera, float spacing) {
  if (surface.empty()) return {};
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& p : surface.points) middle += p;
  middle /= static_cast<float>(surface.size());
  const Eigen::Matrix3f axes = view_axes((camera - middle).normalized());
  const float depth = (camera - middle).norm();
  SeenPoints seen;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3f q = axes * (surface.points[i] - camera);  // z negative
    const float scale = depth / std::max(1e-3f, -q.z());
    seen.points.push_back({scale * q.x(), scale * q.y(), q.z()});
    seen.cosine.push_back(cosine_of(surface, i, (camera - surface.points[i]).normalized()));
  }
  return render_view(seen, axes, spacing);
}

std::array<Eigen::Vector3f, kNumViews> view_directions() {
  std::array<Eigen::Vector3f, kNumViews> directions;
  for (int i = 0; i < kNumViews; ++i) {
    directions[i] = sphere_direction(i, kNumViews).cast<float>();
  }
  return directions;
}

const ModelView& nearest_view(const std::vector<ModelView>& views,
                              const Eigen::Vector3f& direction) {
  return *std::ranges::max_element(
      views, {}, [&](const ModelView& view) { return view.direction.dot(direction); });
}

const ModelView& nearest_view(const std::vector<ModelView>& views,
                              const FastPose& camera_from_object) {
  const FastPose& pose = camera_from_object;
  const Eigen::Vector3f to_camera = -(pose.rotation.transpose() * pose.translation).normalized();
  return nearest_view(views, to_camera);
}

std::vector<ModelView> render_views(const PointCloud& surface, float spacing, int num_threads) {
  const auto directions = view_directions();
  std::vector<ModelView> views(kNumViews);
  if (surface.empty()) return views;
  parallel_for(kNumViews, num_threads,
               [&](int k) { views[k] = render_from_afar(surface, directions[k], spacing); });
  return views;
}

}  // namespace bpa
