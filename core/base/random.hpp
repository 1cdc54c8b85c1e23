// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

namespace bpa {

/// What the detector draws random numbers for: no two purposes share a stream of the same seed.
enum class Stream : std::uint64_t {
  keypoints = 1,
  feature_draws,
  prior_draws,
  segments,
  annealing
};

/// A small, fast stream of random numbers (xoshiro256++ by Blackman and Vigna, seeded by
/// splitmix64). Give every work item its own stream, named by (seed, item). Then results do not
/// depend on which thread does which item. The numbers are the same on every platform, and so are
/// the distributions below (those of <random> are not). Meets UniformRandomBitGenerator.
class RandomStream {
 public:
  using result_type = std::uint64_t;

  /// The stream of one purpose, and of one item of it.
  RandomStream(std::uint64_t seed, Stream purpose, int item = 0)
      : RandomStream(seed, (static_cast<std::uint64_t>(purpose) << 32U) +
                               static_cast<std::uint64_t>(item)) {}
  explicit RandomStream(std::uint64_t seed = 0, std::uint64_t stream = 0) {
    std::uint64_t state = seed ^ (0x9e3779b97f4a7c15ULL * (stream + 1));
    for (std::uint64_t& word : words_) word = splitmix(state);
  }

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }

  result_type operator()() {
    const std::uint64_t result = rotate(words_[0] + words_[3], 23) + words_[0];
    const std::uint64_t t = words_[1] << 17;
    words_[2] ^= words_[0];
    words_[3] ^= words_[1];
    words_[1] ^= words_[2];
    words_[0] ^= words_[3];
    words_[2] ^= t;
    words_[3] = rotate(words_[3], 45);
    return result;
  }

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>((*this)() >> 11) * 0x1.0p-53; }
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform integer in [0, count); count > 0.
  int index(int count) {
    __extension__ using Wide = unsigned __int128;
    const auto wide = static_cast<Wide>((*this)()) * static_cast<std::uint64_t>(count);
    return static_cast<int>(wide >> 64);
  }
  /// Standard normal (Marsaglia's polar method, the second value kept for the next call).
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double u = 0, v = 0, s = 0;
    do {
      u = uniform(-1, 1);
      v = uniform(-1, 1);
      s = u * u + v * v;
    } while (s >= 1 || s == 0);
    const double factor = std::sqrt(-2 * std::log(s) / s);
    spare_ = v * factor;
    has_spare_ = true;
    return u * factor;
  }

 private:
  static std::uint64_t rotate(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }
  static std::uint64_t splitmix(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  std::uint64_t words_[4];
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace bpa
