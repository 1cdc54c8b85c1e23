// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/scenery.hpp"

#include <cmath>
#include <string>

#include "core/base/random.hpp"
#include "core/sim/private/shapes.hpp"

namespace bpa::sim {
namespace {

using Texture = std::function<Color(const Eigen::Vector3d& p)>;

Color wood(const Eigen::Vector3d& p) {
  const double grain = smooth_noise({p.x() * 0.08, p.y(), 1}, 0.008);
  const double board = lattice_noise(static_cast<int>(std::floor(p.y() / 0.11)), 3, 5);
  return mix(Color(0.55, 0.38, 0.22), Color(0.4, 0.26, 0.14), 0.6 * grain + 0.4 * board);
}
Color cloth(const Eigen::Vector3d& p) {
  const double x = p.x() / 0.05, y = p.y() / 0.05;
  const double bands = (x - std::floor(x) < 0.5) + (y - std::floor(y) < 0.5);
  return mix(Color(0.85, 0.83, 0.78), Color(0.55, 0.2, 0.22), 0.5 * bands);
}
// Two colours in spots of about `scale` metres.
Texture mottled(const Color& a, const Color& b, double scale) {
  return [=](const Eigen::Vector3d& p) { return mix(a, b, smooth_noise(p, scale)); };
}

// A rectangle spanned by u and v from a corner, as a grid of steps_u x steps_v cells.
struct Sheet {
  Eigen::Vector3d corner, u, v;
  int steps_u = 1, steps_v = 1;
};

void add_sheet(const Sheet& sheet, const Texture& texture, TriangleMesh& mesh) {
  const auto& [corner, u, v, steps_u, steps_v] = sheet;
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  const Eigen::Vector3f normal = u.cross(v).normalized().cast<float>();
  for (int j = 0; j <= steps_v; ++j) {
    for (int i = 0; i <= steps_u; ++i) {
      const Eigen::Vector3d p = corner + u * i / steps_u + v * j / steps_v;
      const Color c = texture(p);
      mesh.vertices.push_back(p.cast<float>());
      mesh.normals.push_back(normal);
      std::array<std::uint8_t, 3> rgb{};
      for (int k = 0; k < 3; ++k) rgb[k] = static_cast<std::uint8_t>(255 * c[k]);
      mesh.colors.push_back(rgb);
    }
  }
  const int row = steps_u + 1;
  const auto at = [base, row](int i, int j) -> std::uint32_t { return base + j * row + i; };
  for (int j = 0; j < steps_v; ++j) {
    for (int i = 0; i < steps_u; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
}

SimulatedObject make_table(const Texture& texture, const Material& material) {
  constexpr double kThickness = 0.03;
  const Eigen::Vector3d x(2 * kTableHalfX, 0, 0), y(0, 2 * kTableHalfY, 0), down(0, 0, -kThickness);
  const Eigen::Vector3d corner(-kTableHalfX, -kTableHalfY, 0);
  SimulatedObject table{"table", {}, material, {}, {}};
  add_sheet({corner, x, y, 240, 180}, texture, table.mesh);
  add_sheet({corner, down, x, 1, 60}, texture, table.mesh);
  add_sheet({corner + y, x, down, 60, 1}, texture, table.mesh);
  add_sheet({corner, y, down, 60, 1}, texture, table.mesh);
  add_sheet({corner + x, down, y, 1, 60}, texture, table.mesh);
  add_sheet({corner + down, y, x, 1, 1}, texture, table.mesh);
  return table;
}

// A rounded box, a drum or an egg.
struct Lump {
  enum Kind { box, drum, egg } kind = box;
  Eigen::Vector3d center, half_size;

  double distance(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d q = p - center;
    if (kind == box) return box_distance(q, half_size, 0.004);
    if (kind == drum) return cylinder_distance(q, half_size.x(), half_size.z(), 0.003);
    const double k = q.cwiseQuotient(half_size).norm();
    const double g = q.cwiseQuotient(half_size.cwiseAbs2()).norm();
    return g > 1e-9 ? k * (k - 1) / g : -half_size.minCoeff();
  }

  ConvexPart part() const {
    if (kind == box) return box_part(center, half_size);
    constexpr int kTurns = 16;
    ConvexPart corners;
    for (int ring = -2; ring <= 2; ++ring) {
      const double z = kind == drum ? ring / 2.0 : std::sin(0.75 * ring);
      const double r = kind == drum ? 1 : std::cos(0.75 * ring);
      for (int i = 0; i < kTurns; ++i) {
        const double a = 6.283185307179586 * i / kTurns;
        const Eigen::Vector3d unit(r * std::cos(a), r * std::sin(a), z);
        corners.push_back((center + half_size.cwiseProduct(unit)).cast<float>());
      }
    }
    return corners;
  }
};

// Two of them, the second about somewhere in the first.
std::vector<Lump> draw_lumps(RandomStream& random) {
  std::vector<Lump> lumps;
  for (int i = 0; i < 2; ++i) {
    Lump lump{static_cast<Lump::Kind>(random.index(3)), Eigen::Vector3d::Zero(), {}};
    for (double& half : lump.half_size) half = random.uniform(0.014, 0.055);
    if (lump.kind == Lump::drum) lump.half_size.y() = lump.half_size.x();
    if (i == 1) {
      for (int a = 0; a < 3; ++a) lump.center[a] = random.uniform(-1, 1) * lumps[0].half_size[a];
    }
    lumps.push_back(lump);
  }
  return lumps;
}

// A random solid: two lumps that have grown together.
Shape distractor(std::uint64_t index) {
  RandomStream random(0xd157, index);
  const std::vector<Lump> lumps = draw_lumps(random);
  const auto draw_color = [&random] {
    const double blue = random.uniform(0.1, 0.9), green = random.uniform(0.1, 0.9);
    return Color(random.uniform(0.1, 0.9), green, blue);
  };
  const Color base = draw_color(), second = draw_color();
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(0.115);
  const Material material{random.uniform(0.25, 0.8), random.uniform(0, 0.4)};
  Shape shape{"distractor_" + std::to_string(index), {-reach, reach}, material, {}, 0.0035};
  shape.field = [lumps](const Eigen::Vector3d& p) {
    double d = 1e9;
    for (const Lump& lump : lumps) d = smooth_union(d, lump.distance(p), 0.006);
    return d;
  };
  shape.paint = [base, second](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
    return mix(base, second, smooth_noise(p, 0.03) > 0.5 ? 1 : 0);
  };
  for (const Lump& lump : lumps) shape.parts.push_back(lump.part());
  return shape;
}

}  // namespace

std::vector<SimulatedObject> make_tables() {
  const Texture laminate = mottled({0.78, 0.77, 0.74}, {0.7, 0.69, 0.67}, 0.006);
  const Texture slate = mottled({0.2, 0.21, 0.23}, {0.27, 0.28, 0.3}, 0.02);
  return {make_table(wood, {0.6, 0.1}), make_table(laminate, {0.75, 0.2}),
          make_table(slate, {0.45, 0.1}), make_table(cloth, {0.75, 0.0})};
}

SimulatedObject make_room() {
  constexpr double kHalf = 2.5, kHeight = 3;
  const Eigen::Vector3d x(2 * kHalf, 0, 0), y(0, 2 * kHalf, 0), up(0, 0, kHeight);
  const Eigen::Vector3d corner(-kHalf, -kHalf, kFloorHeight);
  SimulatedObject room{"room", {}, {0.55, 0}, {}, {}};
  const Texture carpet = mottled({0.35, 0.31, 0.26}, {0.55, 0.5, 0.42}, 0.03);
  const Texture plaster = mottled({0.72, 0.71, 0.68}, {0.78, 0.77, 0.75}, 0.3);
  add_sheet({corner, x, y, 200, 200}, carpet, room.mesh);
  add_sheet({corner, up, x, 10, 20}, plaster, room.mesh);
  add_sheet({corner + y, x, up, 20, 10}, plaster, room.mesh);
  add_sheet({corner, y, up, 20, 10}, plaster, room.mesh);
  add_sheet({corner + x, up, y, 10, 20}, plaster, room.mesh);
  return room;
}

SimulatedObject make_bin() {
  constexpr double kWall = 0.004, kHeight = 0.1;
  const auto gray = [](const Eigen::Vector3d&) { return Color(0.42, 0.45, 0.5); };
  SimulatedObject bin{"bin", {}, {0.6, 0.1}, {}, {}};
  const auto add_box = [&](const Eigen::Vector3d& center, const Eigen::Vector3d& half) {
    bin.parts.push_back(box_part(center, half));
    for (int axis = 0; axis < 3; ++axis) {
      const auto along = [&](int a) {
        return Eigen::Vector3d(half[a % 3] * Eigen::Vector3d::Unit(a % 3));
      };
      const Eigen::Vector3d n = along(axis), u = 2 * along(axis + 1), v = 2 * along(axis + 2);
      add_sheet({center + n - u / 2 - v / 2, u, v, 1, 1}, gray, bin.mesh);
      add_sheet({center - n - u / 2 - v / 2, v, u, 1, 1}, gray, bin.mesh);
    }
  };
  add_box({0, 0, kWall / 2}, {kBinHalfX, kBinHalfY, kWall / 2});
  for (const double side : {-1.0, 1.0}) {
    add_box({side * (kBinHalfX + kWall / 2), 0, kHeight / 2}, {kWall / 2, kBinHalfY, kHeight / 2});
    add_box({0, side * (kBinHalfY + kWall / 2), kHeight / 2},
            {kBinHalfX + kWall, kWall / 2, kHeight / 2});
  }
  return bin;
}

SimulatedObject make_turntable_plate(double radius, double height) {
  const auto disc = [radius, height](const Eigen::Vector3d& p) {
    return cylinder_distance(p + Eigen::Vector3d(0, 0, height / 2), radius, height / 2, 0.001);
  };
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(0.0105);
  const Eigen::Vector3d low(-radius, -radius, -height), high(radius, radius, 0);
  SimulatedObject plate{"turntable", {}, {0.7, 0.05}, {}, {}};
  plate.mesh = mesh_from_field(disc, low - reach, high + reach, 0.004);
  for (const Eigen::Vector3f& vertex : plate.mesh.vertices) {
    const double sector = 12 * (std::atan2(vertex.y(), vertex.x()) + 3.2) / 3.141592653589793;
    const double r = vertex.head<2>().norm() / radius;
    const bool mark = r > 0.9 && r < 0.97 && sector - std::floor(sector) < 0.3;
    const auto level = static_cast<std::uint8_t>(mark ? 60 : 205);
    plate.mesh.colors.push_back({level, level, level});
  }
  return plate;
}

std::vector<SimulatedObject> make_distractors(int num_threads) {
  constexpr std::uint64_t kCount = 12;
  std::vector<Shape> shapes;
  for (std::uint64_t i = 0; i < kCount; ++i) shapes.push_back(distractor(i));
  return build_objects(shapes, num_threads);
}

}  // namespace bpa::sim
