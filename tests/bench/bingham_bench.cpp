// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include "core/base/random.hpp"
#include "core/bingham/bingham.hpp"
#include "core/bingham/normalizer.hpp"

namespace bpa {
namespace {

void log_normalizer(benchmark::State& state) {
  Eigen::Vector4d lambda(0, -3, -50, -100);
  for (auto _ : state) {
    benchmark::DoNotOptimize(lambda);
    benchmark::DoNotOptimize(bingham_log_normalizer(lambda));
  }
}
BENCHMARK(log_normalizer)->Name("bingham/log_normalizer");

void normalizer_with_derivatives(benchmark::State& state) {
  Eigen::Vector4d lambda(0, -3, -50, -100);
  for (auto _ : state) {
    benchmark::DoNotOptimize(lambda);
    benchmark::DoNotOptimize(bingham_normalizer(lambda));
  }
}
BENCHMARK(normalizer_with_derivatives)->Name("bingham/normalizer_with_derivatives");

void sample(benchmark::State& state) {
  const Bingham bingham =
      Bingham::about(Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {-3.0, -50.0, -100.0});
  RandomStream random(1);
  for (auto _ : state) benchmark::DoNotOptimize(bingham.sample(random));
}
BENCHMARK(sample)->Name("bingham/sample");

Eigen::Matrix4d example_exponent() {
  Eigen::Matrix4d m;
  m << -3, 20, 7, 1, 20, -40, 3, 9, 7, 3, -90, 2, 1, 9, 2, -55;
  return m;
}

void from_exponent(benchmark::State& state) {
  Eigen::Matrix4d m = example_exponent();
  for (auto _ : state) {
    benchmark::DoNotOptimize(m);
    benchmark::DoNotOptimize(Bingham::from_exponent(m));
  }
}
BENCHMARK(from_exponent)->Name("bingham/from_exponent");

void dominant(benchmark::State& state) {
  Eigen::Matrix4d m = example_exponent();
  for (auto _ : state) {
    benchmark::DoNotOptimize(m);
    benchmark::DoNotOptimize(dominant_eigenvector(m));
  }
}
BENCHMARK(dominant)->Name("bingham/dominant_eigenvector");

}  // namespace
}  // namespace bpa
