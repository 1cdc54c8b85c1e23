// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/align/align.hpp"
#include "core/base/random.hpp"

namespace bpa::align {
namespace {

Eigen::Vector3d normal_vector(RandomStream& random, double scale) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return scale * Eigen::Vector3d(x, y, z);
}

// Pairs of one pose, with noise of 5 mm and 8 degrees and every kind of curvature.
std::vector<OrientedPair> oriented_pairs(int count, RandomStream& random) {
  const Eigen::Quaterniond rotation = Bingham().sample(random);
  const Eigen::Vector3d translation(0.1, -0.2, 1);
  std::vector<OrientedPair> pairs(static_cast<std::size_t>(count));
  for (OrientedPair& pair : pairs) {
    pair.model.point = normal_vector(random, 0.05);
    pair.model.orientation = Bingham().sample(random);
    pair.model.lambda3 = pair.scene.lambda3 = random.uniform(-100, 0);
    pair.scene.point = rotation * pair.model.point + translation + normal_vector(random, 0.005);
    const Bingham noise = Bingham::about(rotation * pair.model.orientation, {-50, -50, -50});
    pair.scene.orientation = noise.sample(random);
  }
  return pairs;
}

constexpr int kProblems = 64;  // Different problems in turn, so that branches are not learnt.

std::vector<std::vector<OrientedPair>> problems(int pairs) {
  RandomStream random(1);
  std::vector<std::vector<OrientedPair>> result;
  for (int i = 0; i < kProblems; ++i) result.push_back(oriented_pairs(pairs, random));
  return result;
}

void bpa_mode_10_oriented(benchmark::State& state) {
  const auto data = problems(10);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(bpa_mode({.oriented = data[i++ % kProblems]}));
  }
}
BENCHMARK(bpa_mode_10_oriented)->Name("align/bpa_mode_10_oriented");

void bpa_mode_10_oriented_signs_known(benchmark::State& state) {
  const auto data = problems(10);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        bpa_mode({.oriented = data[i++ % kProblems], .curvature_sign_known = true}));
  }
}
BENCHMARK(bpa_mode_10_oriented_signs_known)->Name("align/bpa_mode_10_oriented_signs_known");

void bpa_mode_2_oriented(benchmark::State& state) {
  const auto data = problems(2);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(bpa_mode({.oriented = data[i++ % kProblems]}));
  }
}
BENCHMARK(bpa_mode_2_oriented)->Name("align/bpa_mode_2_oriented");

void sample_one_correspondence(benchmark::State& state) {
  const auto data = problems(1);
  RandomStream random(2);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(bpa_sample_one(data[i++ % kProblems][0], random));
  }
}
BENCHMARK(sample_one_correspondence)->Name("align/sample_one_correspondence");

void icp_mode_10(benchmark::State& state) {
  const auto data = problems(10);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(icp_mode({.oriented = data[i++ % kProblems]}));
  }
}
BENCHMARK(icp_mode_10)->Name("align/icp_mode_10");

void eigen_umeyama_10(benchmark::State& state) {
  std::vector<Eigen::Matrix<double, 3, 10>> model(kProblems), scene(kProblems);
  const auto data = problems(10);
  for (std::size_t i = 0; i < kProblems; ++i) {
    for (int k = 0; k < 10; ++k) {
      model[i].col(k) = data[i][static_cast<std::size_t>(k)].model.point;
      scene[i].col(k) = data[i][static_cast<std::size_t>(k)].scene.point;
    }
  }
  std::size_t i = 0;
  for (auto _ : state) {
    const std::size_t problem = i++ % kProblems;
    benchmark::DoNotOptimize(Eigen::umeyama(model[problem], scene[problem], false));
  }
}
BENCHMARK(eigen_umeyama_10)->Name("align/eigen_umeyama_10");

}  // namespace
}  // namespace bpa::align
