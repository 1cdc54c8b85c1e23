// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The bound of core/modeling/README.md: a model of any mesh costs 30 s of CPU and 1 GB at most.
#include <bit>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "core/io/mesh_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/system/cli/box_scene.hpp"

namespace bpa {
namespace {

/// This is a promise to users, no measurement of speed. CPU seconds of the programs that have
/// ended.
double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto of = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return of(usage.ru_utime) + of(usage.ru_stime);
}

/// The most that one of them held.
double peak_gigabytes() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return static_cast<double>(usage.ru_maxrss) / (1024 * 1024);
}

template <class T>
void put(std::string& bytes, T number) {
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(number);
  bytes.append(raw.data(), raw.size());
}

/// A ball as STL, whose triangles have normals of their own: no two share a vertex.
std::string facetted_ball(float radius, int rings) {
  const auto point = [&](int ring, int k) {
    const float down =
        std::numbers::pi_v<float> * static_cast<float>(ring) / static_cast<float>(rings);
    const float round =
        std::numbers::pi_v<float> * static_cast<float>(k % (2 * rings)) / static_cast<float>(rings);
    return Eigen::Vector3f(std::sin(down) * std::cos(round), std::sin(down) * std::sin(round),
                           std::cos(down));
  };
  std::string triangles;
  std::uint32_t count = 0;
  const auto add = [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                       const Eigen::Vector3f& c) {
    const Eigen::Vector3f normal = (a + b + c).normalized();
    for (const Eigen::Vector3f& v : {normal, Eigen::Vector3f(radius * a),
                                     Eigen::Vector3f(radius * b), Eigen::Vector3f(radius * c)}) {
      for (int k = 0; k < 3; ++k) put(triangles, v[k]);
    }
    put(triangles, std::uint16_t{0});
    ++count;
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int k = 0; k < 2 * rings; ++k) {
      const Eigen::Vector3f a = point(ring, k), b = point(ring + 1, k), c = point(ring + 1, k + 1);
      if (ring + 1 < rings) add(a, b, c);
      if (ring > 0) add(a, c, point(ring, k + 1));
    }
  }
  std::string bytes(80, ' ');
  put(bytes, count);
  return bytes + triangles;
}

TEST(Model, OfAnyMeshCostsABoundedAmount) {
  constexpr double kSeconds = 30, kGigabytes = 1;
  constexpr double kBusy = 2;  // processors that others use cost more time for the same work
  const test::TemporaryFolder folder;
  // A side of 1 m; 3 m from corner to corner, such as a part of 67 inches taken for metres.
  ASSERT_TRUE(io::write_ply(folder / "cube.ply", test::box(0.5f, 0.5f, 0.5f)).ok());
  ASSERT_TRUE(io::write_ply(folder / "large.ply", test::box(0.85f, 0.85f, 0.85f)).ok());
  test::spill(folder / "ball.stl", facetted_ball(1.45f, 600));  // 1 437 600 triangles
  for (const char* name : {"cube.ply", "large.ply", "ball.stl"}) {
    const double before = cpu_seconds();
    const test::Outcome outcome = test::run("model from-mesh " + (folder / name) +
                                            " --unit m --name b --library " + (folder / "L"));
    EXPECT_EQ(outcome.code, 0) << outcome.out;
    EXPECT_LT(cpu_seconds() - before, kBusy * kSeconds) << name;
    EXPECT_LT(peak_gigabytes(), kGigabytes) << name;
  }
  // Without a unit it is refused before the work.
  const double before = cpu_seconds();
  const test::Outcome no_unit = test::run("model from-mesh " + (folder / "large.ply") +
                                          " --name b --library " + (folder / "L"));
  EXPECT_EQ(no_unit.code, 1);
  EXPECT_NE(no_unit.out.find("--unit in (43 mm)"), std::string::npos) << no_unit.out;
  EXPECT_LT(cpu_seconds() - before, 2);
}

}  // namespace
}  // namespace bpa
