// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/objects.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <unordered_map>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa::sim {
namespace {

const std::vector<SimulatedObject>& objects() {
  static const std::vector<SimulatedObject> all = [] {
    std::vector<SimulatedObject> both = household_objects();
    for (SimulatedObject& tool : workshop_objects()) both.push_back(std::move(tool));
    return both;
  }();
  return all;
}

double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>();
    sum += a.dot(b.cross(mesh.vertices[t[2]].cast<double>())) / 6;
  }
  return sum;
}

// Distance from a point to the tangent plane of the nearest vertex, by a hash of cells.
class NearSurface {
 public:
  explicit NearSurface(const TriangleMesh& mesh) : mesh_(mesh) {
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      cells_[key(cell_of(mesh.vertices[i]))].push_back(i);
    }
  }
  double distance(const Eigen::Vector3f& p) const {
    const Eigen::Vector3i center = cell_of(p);
    float best = 1e9f;
    std::size_t nearest = 0;
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const auto found = cells_.find(key(center + Eigen::Vector3i(x, y, z)));
          if (found == cells_.end()) continue;
          for (const std::size_t i : found->second) {
            const float squared = (mesh_.vertices[i] - p).squaredNorm();
            if (squared < best) {
              best = squared;
              nearest = i;
            }
          }
        }
      }
    }
    if (best > 1e8f) return kCell;  // at least
    const double plane = std::abs((p - mesh_.vertices[nearest]).dot(mesh_.normals[nearest]));
    return best > 0.004f * 0.004f ? std::sqrt(best) : plane;
  }

 private:
  static constexpr float kCell = 0.006f;
  static Eigen::Vector3i cell_of(const Eigen::Vector3f& p) {
    return (p / kCell).array().floor().cast<int>();
  }
  static long key(const Eigen::Vector3i& c) {
    return (c.x() + 512L) | (c.y() + 512L) << 10 | (c.z() + 512L) << 20;
  }
  const TriangleMesh& mesh_;
  std::unordered_map<long, std::vector<std::size_t>> cells_;
};

struct Deviation {
  double mean = 0, largest = 0;
};

Deviation deviation(const TriangleMesh& mesh, const NearSurface& surface, const Pose& motion) {
  Deviation result;
  int count = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 7, ++count) {
    const Eigen::Vector3d moved = motion * mesh.vertices[i].cast<double>();
    const double d = surface.distance(moved.cast<float>());
    result.mean += d;
    result.largest = std::max(result.largest, d);
  }
  result.mean /= count;
  return result;
}

Pose turn(const Eigen::Vector3d& axis, double angle) {
  return {rotation_from_vector(angle * axis), Eigen::Vector3d::Zero()};
}

TEST(Objects, AreEighteenAndFourteenWithDifferentNames) {
  std::set<std::string> names;
  for (const SimulatedObject& object : objects()) names.insert(object.name);
  EXPECT_EQ(names.size(), 18u + 14u);
}

TEST(Objects, AreClosedOrientedAndOfHouseholdSize) {
  for (const SimulatedObject& object : objects()) {
    SCOPED_TRACE(object.name);
    const TriangleMesh& mesh = object.mesh;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
    for (const auto& t : mesh.triangles) {
      for (int k = 0; k < 3; ++k) ++directed[{t[k], t[(k + 1) % 3]}];
    }
    int open_edges = 0;
    for (const auto& [edge, count] : directed) {
      const auto opposite = directed.find({edge.second, edge.first});
      open_edges += count != 1 || opposite == directed.end() || opposite->second != 1;
    }
    EXPECT_EQ(open_edges, 0);
    EXPECT_GT(volume(mesh), 2e-5);
    EXPECT_LT(volume(mesh), 2e-3);
    EXPECT_GT(diameter(mesh), 0.07);
    EXPECT_LT(diameter(mesh), 0.3);
    EXPECT_EQ(mesh.colors.size(), mesh.vertices.size());
    EXPECT_EQ(mesh.normals.size(), mesh.vertices.size());
    EXPECT_LT(mesh.triangles.size(), 120000u);
  }
}

TEST(Objects, BoundingBoxIsCentred) {
  for (const SimulatedObject& object : objects()) {
    Eigen::Vector3f low = object.mesh.vertices.front(), high = low;
    for (const Eigen::Vector3f& v : object.mesh.vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    EXPECT_LT((low + high).norm() / 2, 0.0012f) << object.name;
  }
}

TEST(Objects, VolumesAgreeWithClosedForms) {
  const double pi = std::numbers::pi;
  const auto check = [](const char* name, double expected, double tolerance) {
    const SimulatedObject object = household_objects(std::vector<std::string>{name}).front();
    EXPECT_NEAR(volume(object.mesh) / expected, 1, tolerance) << name;
  };
  check("cereal_box", 0.056 * 0.15 * 0.2, 0.01);
  check("cube", 0.057 * 0.057 * 0.057, 0.01);
  check("tube", pi * 0.17 * (0.0227 * 0.0227 - 0.0183 * 0.0183), 0.02);
  check("tin", pi * 0.042 * 0.042 * 0.034, 0.01);
  check("phone", 0.146 * 0.072 * 0.01, 0.06);
  check("matchbox", 0.08 * 0.05 * 0.024, 0.02);
  check("l_brick", 0.04 * (0.09 * 0.03 + 0.03 * 0.03), 0.01);
}

TEST(Objects, DeclaredSymmetriesHold) {
  for (const SimulatedObject& object : objects()) {
    const NearSurface surface(object.mesh);
    std::vector<Pose> motions = object.symmetry.discrete;
    for (const ContinuousSymmetry& s : object.symmetry.continuous) {
      for (const double angle : {0.1, 0.7, 1.9, 3.0}) motions.push_back(turn(s.axis, angle));
    }
    for (const Pose& motion : motions) {
      const Deviation d = deviation(object.mesh, surface, motion);
      EXPECT_LT(d.mean, 1e-4) << object.name;
      EXPECT_LT(d.largest, 1.2e-3) << object.name;
    }
  }
}

TEST(Objects, HaveNoFurtherSymmetriesOfLowOrder) {
  std::vector<Pose> candidates;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int order : {2, 3, 4, 6}) {
      candidates.push_back(turn(Eigen::Vector3d::Unit(axis), 2 * std::numbers::pi / order));
    }
  }
  for (const SimulatedObject& object : objects()) {
    const NearSurface surface(object.mesh);
    for (const Pose& candidate : candidates) {
      const Pose nearest = nearest_symmetric_pose(Pose{}, candidate, object.symmetry);
      if (pose_error(nearest, candidate).angle < 1e-6) continue;
      EXPECT_GT(deviation(object.mesh, surface, candidate).mean, 4e-4)
          << object.name << " turned by " << vector_from_rotation(candidate.rotation).transpose();
    }
  }
}

// What collides must be where the mesh is: no part sticks out, and the parts reach the mesh's box.
TEST(Objects, ConvexPartsFillTheMesh) {
  for (const SimulatedObject& object : objects()) {
    Eigen::AlignedBox3f mesh_box, part_box;
    for (const Eigen::Vector3f& v : object.mesh.vertices) mesh_box.extend(v);
    for (const ConvexPart& part : object.parts) {
      for (const Eigen::Vector3f& p : part) part_box.extend(p);
    }
    EXPECT_LT((mesh_box.min() - part_box.min()).cwiseAbs().maxCoeff(), 0.004f) << object.name;
    EXPECT_LT((mesh_box.max() - part_box.max()).cwiseAbs().maxCoeff(), 0.004f) << object.name;
  }
}

TEST(Objects, MadeInexactlyAreStretchedAlongTheirAxes) {
  const SimulatedObject& exact = objects().front();
  double sum = 0, squares = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const SimulatedObject made = made_inexactly(exact, 0.02, seed);
    ASSERT_EQ(made.mesh.triangles, exact.mesh.triangles);
    for (int axis = 0; axis < 3; ++axis) {
      const auto ratio = [&](std::size_t i) {
        return made.mesh.vertices[i][axis] / exact.mesh.vertices[i][axis] - 1;
      };
      std::size_t i = 0;
      while (std::abs(exact.mesh.vertices[i][axis]) < 0.01f) ++i;
      EXPECT_NEAR(made.parts[0][0][axis], (1 + ratio(i)) * exact.parts[0][0][axis], 1e-5);
      sum += static_cast<double>(ratio(i));
      squares += std::pow(static_cast<double>(ratio(i)), 2);
    }
  }
  EXPECT_NEAR(sum / 300, 0, 4 * 0.02 / std::sqrt(300.0));
  EXPECT_NEAR(std::sqrt(squares / 300), 0.02, 0.004);
  EXPECT_EQ(made_inexactly(exact, 0.02, 3).mesh.vertices,
            made_inexactly(exact, 0.02, 3).mesh.vertices);
}

TEST(Objects, AreTheSameForAnyNumberOfThreads) {
  const std::vector<std::string> names{"mug", "gear"};
  const auto one = household_objects(names, 1), two = household_objects(names, 2);
  ASSERT_EQ(one.size(), 2u);
  EXPECT_EQ(one[1].name, "gear");
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(one[i].mesh.vertices, two[i].mesh.vertices);
    EXPECT_EQ(one[i].mesh.colors, two[i].mesh.colors);
  }
}

TEST(Objects, PrintedOtherwiseHaveTheSameShapeAndOtherColours) {
  const SimulatedObject can = household_objects(std::vector<std::string>{"can"}).front();
  const SimulatedObject one = printed_otherwise(can, 1);
  EXPECT_EQ(one.mesh.vertices, can.mesh.vertices);
  EXPECT_EQ(one.mesh.triangles, can.mesh.triangles);
  ASSERT_EQ(one.mesh.colors.size(), can.mesh.vertices.size());
  EXPECT_EQ(printed_otherwise(can, 1).mesh.colors, one.mesh.colors) << "the same seed";
  const std::set<std::array<std::uint8_t, 3>> shades(one.mesh.colors.begin(),
                                                     one.mesh.colors.end());
  EXPECT_GE(shades.size(), 3u) << "ground, band and print";
  const auto changed = [&](const SimulatedObject& a, const SimulatedObject& b) {
    int count = 0;
    for (std::size_t i = 0; i < a.mesh.colors.size(); ++i) {
      count += a.mesh.colors[i] != b.mesh.colors[i];
    }
    return static_cast<double>(count) / static_cast<double>(a.mesh.colors.size());
  };
  EXPECT_GT(changed(one, can), 0.9);
  EXPECT_GT(changed(one, printed_otherwise(can, 2)), 0.9);
}

TEST(Objects, VariedOnesAreOfAllKindsAndOfOtherSizes) {
  const std::vector<SimulatedObject> varied = varied_objects(34);
  const std::vector<SimulatedObject>& originals = objects();
  ASSERT_EQ(varied.size(), 34u);
  for (std::size_t i = 0; i < varied.size(); ++i) {
    const SimulatedObject& original = originals[i % 32];
    EXPECT_EQ(varied[i].name, original.name + (i < 32 ? "_1" : "_2"));
    EXPECT_EQ(varied[i].mesh.triangles, original.mesh.triangles);
    const double ratio = diameter(varied[i].mesh) / diameter(original.mesh);
    EXPECT_GT(ratio, 0.4) << varied[i].name;
    EXPECT_LT(ratio, 1.6) << varied[i].name;
    EXPECT_GT(std::abs(ratio - 1), 1e-4) << varied[i].name;
  }
  EXPECT_NE(varied[0].mesh.vertices, varied[32].mesh.vertices) << "two mugs";
  const std::vector<SimulatedObject> fewer = varied_objects(2, 1);
  for (std::size_t i = 0; i < fewer.size(); ++i) {
    EXPECT_EQ(fewer[i].mesh.vertices, varied[i].mesh.vertices);
    EXPECT_EQ(fewer[i].mesh.colors, varied[i].mesh.colors);
  }
}

// The mug says itself which vertices are its handle's.
TEST(Objects, WhatStandsOutOfAMugIsItsHandle) {
  const auto vessels = household_objects({"mug", "can", "milk_carton"});
  std::vector<int> telltales = vessels[0].telltales;
  std::ranges::sort(telltales);
  const std::vector<int> found = protruding_vertices(vessels[0].mesh);
  ASSERT_FALSE(found.empty());
  const auto known = std::ranges::count_if(
      found, [&](int vertex) { return std::ranges::binary_search(telltales, vertex); });
  EXPECT_GE(known, 0.95 * double(found.size()));
  EXPECT_GE(known, 0.6 * double(telltales.size()));
  EXPECT_TRUE(protruding_vertices(vessels[1].mesh).empty());
  EXPECT_TRUE(protruding_vertices(vessels[2].mesh).empty());
  EXPECT_TRUE(protruding_vertices({}).empty());
}

}  // namespace
}  // namespace bpa::sim
