// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/active_stereo.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "core/sim/private/infrared.hpp"

namespace bpa::sim {
namespace {

constexpr int kHalfWindow = 4;           // pixels: 9 x 9
constexpr float kOneMatch = 1;           // pixels of disparity within a window's surface
constexpr float kNearWins = 0.25f;       // of a window
constexpr float kEnough = 0.3f;          // of a window, for any match
constexpr float kRagged = 0.1f;          // standard deviation of both shares
constexpr float kWeakContrast = 0.032f;  // where half of all pixels fail

// The left image, row-major. Disparity is 0 where there is nothing in range.
struct LeftImage {
  Camera camera;
  cv::Mat_<float> disparity;  // true, pixels
  cv::Mat_<float> matched;    // the same, 0 where the right camera does not see it
  cv::Mat_<float> contrast;   // of the dots and of the surface; 1 = white, facing, at 1 m
  cv::Mat_<float> glare;      // in [0, 1]
};

// The standard deviation of an image within the window.
cv::Mat_<float> local_deviation(const cv::Mat_<float>& image) {
  const cv::Size window(2 * kHalfWindow + 1, 2 * kHalfWindow + 1);
  cv::Mat_<float> mean, squares, variance;
  cv::boxFilter(image, mean, CV_32F, window);
  cv::boxFilter(image.mul(image), squares, CV_32F, window);
  cv::sqrt(cv::max(squares - mean.mul(mean), 0), variance);
  return variance;
}

// Steps 1 and 2.
LeftImage see(const InfraredCamera& left, const ActiveStereoOptions& options, int num_threads) {
  constexpr float kOwnTexture = 0.5f;  // contrast of the surface against that of the dots
  const Camera& camera = left.camera();
  const auto zeros = [&] { return cv::Mat_<float>(camera.height, camera.width, 0.0f); };
  LeftImage m{camera, zeros(), zeros(), zeros(), zeros()};
  cv::Mat_<float> brightness = zeros();
  const Eigen::Vector3f right = left.beside(options.baseline);
  const Eigen::Vector3f projector = left.beside(0.5 * options.baseline);
  for_each_pixel(camera, num_threads, [&](int x, int y, int) {
    const auto seen = left.look(left.origin(), left.direction(x, y));
    if (!seen) return;
    const float z = seen->hit.distance;
    if (z < options.min_range || z > options.max_range) return;
    const auto disparity = static_cast<float>(camera.fx * options.baseline / z);
    m.disparity(y, x) = disparity;
    const float facing = seen->hit.face_normal.dot((projector - seen->point).normalized());
    brightness(y, x) = left.brightness(seen->hit);
    m.contrast(y, x) =
        left.reflectance(seen->hit) * std::sqrt(std::max(facing, 0.0f)) / std::pow(z, 1.5f);
    m.glare(y, x) = seen->glare(left.material(seen->hit), projector);
    const bool inside = static_cast<float>(x) >= disparity;
    if (inside && !left.scene().blocked(seen->lifted, right)) m.matched(y, x) = disparity;
  });
  m.contrast += kOwnTexture * local_deviation(brightness).mul(m.contrast);
  return m;
}

// The random images that the measurement draws on.
struct StereoNoise {
  std::vector<float> shared, own, match, drop;

  StereoNoise(const Camera& camera, std::uint64_t seed, int shot, int num_threads) {
    NoiseFields fields(camera, seed, shot, num_threads);
    shared = fields.next(kHalfWindow);
    own = fields.next(0);
    match = fields.next(3);
    drop = fields.next(kHalfWindow);
  }
};

// What of a window's matches lies within kOneMatch of a disparity.
struct Support {
  float share = 0;  // of the window
  float mean = 0;   // pixels
};

Support support(const LeftImage& m, int x, int y, float disparity) {
  constexpr int kSide = 2 * kHalfWindow + 1;
  float sum = 0;
  int count = 0;
  for (int v = std::max(y - kHalfWindow, 0); v <= std::min(y + kHalfWindow, m.camera.height - 1);
       ++v) {
    const float* row = m.matched[v];
    for (int u = std::max(x - kHalfWindow, 0); u <= std::min(x + kHalfWindow, m.camera.width - 1);
         ++u) {
      if (std::abs(row[u] - disparity) > kOneMatch) continue;
      sum += row[u];
      ++count;
    }
  }
  return {static_cast<float>(count) / (kSide * kSide),
          count > 0 ? sum / static_cast<float>(count) : 0};
}

// Step 3: the disparity that the window at (x, y) is matched with, or 0. `nearest` is the largest
// of the window.
float matched_disparity(const LeftImage& m, const ActiveStereoOptions& options, int x, int y,
                        float nearest, float jitter) {
  const float own = m.matched(y, x);
  if (options.fattening > 0 && nearest - m.disparity(y, x) > kOneMatch) {
    const Support near = support(m, x, y, nearest);
    if (near.share > kNearWins / static_cast<float>(options.fattening) + jitter) return near.mean;
  }
  if (own <= 0) return 0;
  const Support same = support(m, x, y, own);
  return same.share > kEnough + jitter ? same.mean : 0;
}

// Steps 3 to 5 for one pixel: its depth, or 0.
float measure(const LeftImage& m, const StereoNoise& noise, const ActiveStereoOptions& options,
              float nearest, int x, int y) {
  const int i = y * m.camera.width + x;
  double disparity = matched_disparity(m, options, x, y, nearest, kRagged * noise.match[i]);
  if (disparity <= 0) return 0;
  const float weakness = kWeakContrast / std::max(m.contrast(y, x), 1e-6f);
  const double faint = 1 / (1 + std::pow(weakness, -6.0));
  const double chance = options.dropouts * (0.0001 + faint + 0.9 * m.glare(y, x));
  if (0.5 * std::erfc(-noise.drop[i] / std::numbers::sqrt2) < chance) return 0;
  constexpr double kShared = 0.95;  // of the variance
  const double unit = std::sqrt(kShared) * noise.shared[i] + std::sqrt(1 - kShared) * noise.own[i];
  disparity += options.disparity_noise * (1 + std::min(weakness * weakness, 1.0f)) * unit;
  if (options.disparity_step > 0) {
    disparity = options.disparity_step * std::round(disparity / options.disparity_step);
  }
  if (disparity <= 0) return 0;
  const double depth = m.camera.fx * options.baseline / disparity;
  return static_cast<float>(options.disparity_step > 0 ? 1e-3 * std::round(1e3 * depth) : depth);
}

}  // namespace

Frame simulate_depth(const SensorView& view, const ActiveStereoOptions& options, std::uint64_t seed,
                     int shot, int num_threads) {
  const InfraredCamera left = infrared_camera(view, options.width, options.height, options);
  const LeftImage m = see(left, options, num_threads);
  const StereoNoise noise(m.camera, seed, shot, num_threads);
  cv::Mat_<float> nearest;
  cv::dilate(m.matched, nearest, cv::Mat::ones(2 * kHalfWindow + 1, 2 * kHalfWindow + 1, CV_8U));
  std::vector<float> depth(m.disparity.total(), 0);
  for_each_pixel(m.camera, num_threads, [&](int x, int y, int i) {
    depth[i] = measure(m, noise, options, nearest(y, x), x, y);
  });
  return depth_frame(view, m.camera, std::move(depth), options);
}

}  // namespace bpa::sim
