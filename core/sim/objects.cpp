// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/objects.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/geometry/sphere_directions.hpp"
#include "core/sim/private/shapes.hpp"

namespace bpa::sim {
namespace {

std::vector<Shape> household_shapes() {
  std::vector<Shape> shapes = vessel_shapes();
  for (Shape& shape : solid_shapes()) shapes.push_back(std::move(shape));
  return shapes;
}

void paint_mesh(const Paint& paint, TriangleMesh& mesh) {
  mesh.colors.resize(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d normal =
        mesh.normals.empty() ? Eigen::Vector3d::Zero() : mesh.normals[i].cast<double>().eval();
    const Color color = paint(mesh.vertices[i].cast<double>(), normal);
    for (int c = 0; c < 3; ++c) {
      mesh.colors[i][c] =
          static_cast<std::uint8_t>(std::lround(255 * std::clamp(color[c], 0.0, 1.0)));
    }
  }
}

SimulatedObject build_object(const Shape& shape) {
  SimulatedObject object{shape.name, {}, shape.material, shape.symmetry, shape.parts};
  const auto& [low, high] = shape.bounds;
  const Eigen::Vector3d center = (low + high) / 2;
  // The grid is symmetric about the centre and has no sample on planes through it.
  const Eigen::Vector3d half_size = (high - low) / 2;
  const Eigen::Vector3d reach =
      shape.cell * ((half_size.array() / shape.cell).ceil() + 2.5).matrix();
  object.mesh = mesh_from_field(shape.field, center - reach, center + reach, shape.cell);
  paint_mesh(shape.paint, object.mesh);
  for (std::size_t i = 0; shape.telltale && i < object.mesh.vertices.size(); ++i) {
    if (shape.telltale(object.mesh.vertices[i].cast<double>())) {
      object.telltales.push_back(static_cast<int>(i));
    }
  }
  const Eigen::Vector3f shift = center.cast<float>();
  for (Eigen::Vector3f& vertex : object.mesh.vertices) vertex -= shift;
  for (ConvexPart& part : object.parts) {
    for (Eigen::Vector3f& point : part) point -= shift;
  }
  return object;
}

}  // namespace

std::vector<SimulatedObject> build_objects(const std::vector<Shape>& shapes, int num_threads) {
  std::vector<SimulatedObject> objects(shapes.size());
  parallel_for(shapes.size(), num_threads,
               [&](std::size_t i) { objects[i] = build_object(shapes[i]); });
  return objects;
}

std::vector<SimulatedObject> household_objects(int num_threads) {
  return build_objects(household_shapes(), num_threads);
}

std::vector<SimulatedObject> workshop_objects(int num_threads) {
  return build_objects(tool_shapes(), num_threads);
}

std::vector<SimulatedObject> household_objects(const std::vector<std::string>& names,
                                               int num_threads) {
  std::vector<Shape> shapes = household_shapes();
  for (Shape& shape : tool_shapes()) shapes.push_back(std::move(shape));
  std::vector<Shape> chosen;
  for (const std::string& name : names) {
    const auto found = std::ranges::find(shapes, name, &Shape::name);
    if (found != shapes.end()) chosen.push_back(*found);
  }
  return build_objects(chosen, num_threads);
}

SimulatedObject object_from_mesh(std::string name, TriangleMesh mesh,
                                 const SymmetryGroup& symmetry) {
  // The outermost vertices along many directions are enough of the hull to collide.
  ConvexPart hull = outermost(mesh.vertices, 120);
  return {std::move(name), std::move(mesh), {}, symmetry, {std::move(hull)}};
}

SimulatedObject made_inexactly(SimulatedObject object, double error, std::uint64_t seed) {
  RandomStream random(seed);
  Eigen::Array3f scale;
  for (int axis = 0; axis < 3; ++axis)
    scale[axis] = static_cast<float>(1 + error * random.normal());
  for (Eigen::Vector3f& vertex : object.mesh.vertices) vertex.array() *= scale;
  for (ConvexPart& part : object.parts) {
    for (Eigen::Vector3f& corner : part) corner.array() *= scale;
  }
  return object;
}

SimulatedObject printed_otherwise(SimulatedObject object, std::uint64_t seed) {
  RandomStream random(seed);
  const auto any_color = [&] {
    const double red = random.uniform(0.05, 0.95), green = random.uniform(0.05, 0.95);
    return Color(red, green, random.uniform(0.05, 0.95));
  };
  const Color ground = any_color(), band = any_color(), ink = any_color();
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : object.mesh.vertices) box.extend(vertex);
  const double height = double{box.sizes().z()};
  const double bottom = double{box.min().z()} + random.uniform(0, 0.5) * height;
  const double top = bottom + random.uniform(0.25, 0.5) * height;
  const double letter = random.uniform(0.006, 0.02);
  object.mesh.textures.clear();
  paint_mesh(
      [&](const Eigen::Vector3d& p, const Eigen::Vector3d& n) -> Color {
        if (p.z() < bottom || p.z() > top) return ground;
        const double u = std::abs(n.x()) > std::abs(n.y()) ? p.y() : p.x();
        return mix(band, ink, print_pattern(u, p.z(), letter));
      },
      object.mesh);
  return object;
}

std::vector<SimulatedObject> varied_objects(int count, int num_threads) {
  constexpr double kDifference = 0.15;
  constexpr std::uint64_t kSizes = 4000, kPrints = 5000;  // streams of random numbers
  std::vector<SimulatedObject> originals = household_objects(num_threads);
  for (SimulatedObject& tool : workshop_objects(num_threads)) originals.push_back(std::move(tool));
  std::vector<SimulatedObject> objects(static_cast<std::size_t>(count));
  parallel_for(objects.size(), num_threads, [&](std::size_t i) {
    const std::size_t turn = i / originals.size();
    const SimulatedObject sized =
        made_inexactly(originals[i % originals.size()], kDifference, RandomStream(kSizes, i)());
    objects[i] = printed_otherwise(sized, RandomStream(kPrints, i)());
    objects[i].name = concat(objects[i].name, "_", turn + 1);
  });
  return objects;
}

double diameter(const TriangleMesh& mesh) { return largest_distance(mesh.vertices, 2000); }

}  // namespace bpa::sim
