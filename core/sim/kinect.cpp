// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/kinect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "core/sim/private/infrared.hpp"

namespace bpa::sim {
namespace {

constexpr int kWindow = 4;           // pixels on each side: 9 x 9
constexpr float kSameDisparity = 1;  // pixels
constexpr float kEnoughOfWindow = 0.42f;
constexpr float kEnoughOfOther = 0.28f;  // where the surface beside answers

// What the infrared camera gets to see, row-major.
struct Measurement {
  Camera camera;
  std::vector<float> depth;      // true, metres
  std::vector<float> disparity;  // true, pixels; 0 where the pattern is not seen
  std::vector<float> angle;      // of incidence, radians
  std::vector<float> signal;     // returned light; 1 = white, facing, at 1 m
  std::vector<float> glare;      // in [0, 1]
};

// The smallest box about the pixels that are measured; none where there are none.
std::optional<Eigen::AlignedBox2i> measured_part(const InfraredCamera& infrared) {
  Eigen::AlignedBox2i box;
  for (int y = 0, i = 0; y < infrared.camera().height; ++y) {
    for (int x = 0; x < infrared.camera().width; ++x, ++i) {
      if (infrared.wanted(i)) box.extend(Eigen::Vector2i(x, y));
    }
  }
  if (box.isEmpty()) return std::nullopt;
  return box;
}

// Where a pixel sees a surface, and how it faces the projector.
struct SeenPixel {
  int pixel = 0;
  InfraredHit seen;
  float lit = 0;  // cosine
};

// What the wanted pixels of a row see within the sensor's range.
std::vector<SeenPixel> see_row(const InfraredCamera& infrared, const KinectOptions& options,
                               const Eigen::Vector3f& projector, int y) {
  const int width = infrared.camera().width;
  std::vector<int> pixels;
  std::vector<Eigen::Vector3f> directions;
  for (int x = 0; x < width; ++x) {
    if (!infrared.wanted(y * width + x)) continue;
    pixels.push_back(y * width + x);
    directions.push_back(infrared.direction(x, y));
  }
  const auto all = infrared.look(directions);
  std::vector<SeenPixel> out;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!all[k]) continue;
    const RayHit& hit = all[k]->hit;
    if (hit.distance < options.min_range || hit.distance > options.max_range) continue;
    out.push_back(
        {pixels[k], *all[k], hit.face_normal.dot((projector - all[k]->point).normalized())});
  }
  return out;
}

// Takes out what the projector does not reach.
void drop_shadows(const RayScene& scene, const Eigen::Vector3f& projector,
                  std::vector<SeenPixel>& row) {
  std::erase_if(row, [](const SeenPixel& p) { return p.lit <= 0; });
  std::vector<Eigen::Vector3f> from;
  for (const SeenPixel& p : row) from.push_back(p.seen.lifted);
  const std::vector<std::uint8_t> blocked = scene.blocked(from, projector);
  std::vector<SeenPixel> reached;
  for (std::size_t k = 0; k < row.size(); ++k) {
    if (blocked[k] == 0) reached.push_back(row[k]);
  }
  row = std::move(reached);
}

// What the projector's light makes of a pixel that it reaches.
void light_up(const InfraredCamera& infrared, const KinectOptions& options,
              const Eigen::Vector3f& projector, const SeenPixel& p, Measurement& m) {
  const RayHit& hit = p.seen.hit;
  const Material material = infrared.material(hit);
  const auto shine = static_cast<float>(material.shine);
  const float away = 1 - 0.6f * shine * p.seen.angle / (std::numbers::pi_v<float> / 2);
  m.signal[p.pixel] = infrared.reflectance(hit) * std::sqrt(std::max(p.lit, 0.0f)) * away /
                      std::pow(hit.distance, 1.5f);
  m.glare[p.pixel] = p.seen.glare(material, projector);
  m.disparity[p.pixel] =
      static_cast<float>(m.camera.fx * std::max(options.baseline, 1e-3) / hit.distance);
}

// Steps 1 and 3.
Measurement see(const InfraredCamera& infrared, const KinectOptions& options, int num_threads) {
  const Camera& camera = infrared.camera();
  const std::vector<float> zeros(camera.width * camera.height, 0);
  Measurement m{camera, zeros, zeros, zeros, zeros, zeros};
  const Eigen::Vector3f projector = infrared.beside(options.baseline);
  parallel_for(camera.height, num_threads, [&](int y) {
    std::vector<SeenPixel> row = see_row(infrared, options, projector, y);
    for (const SeenPixel& p : row) {
      m.depth[p.pixel] = p.seen.hit.distance;
      m.angle[p.pixel] = p.seen.angle;
    }
    if (options.shadows) drop_shadows(infrared.scene(), projector, row);
    for (const SeenPixel& p : row) light_up(infrared, options, projector, p, m);
  });
  return m;
}

// Whether at least a share of the matching window round (x, y) is lit and has about this disparity.
bool window_agrees(const Measurement& m, int x, int y, float disparity, float share) {
  constexpr float kPixels = (2 * kWindow + 1) * (2 * kWindow + 1);
  int agree = 0;
  for (int v = std::max(y - kWindow, 0); v <= std::min(y + kWindow, m.camera.height - 1); ++v) {
    const float* row = m.disparity.data() + v * m.camera.width;
    for (int u = std::max(x - kWindow, 0); u <= std::min(x + kWindow, m.camera.width - 1); ++u) {
      agree += std::abs(row[u] - disparity) <= kSameDisparity;
    }
    if (static_cast<float>(agree) / kPixels >= share) return true;
  }
  return false;
}

// The random images that the measurement draws on.
struct Noise {
  std::vector<float> lateral_x, lateral_y, shared, own, match, drop, smooth;

  Noise(const InfraredCamera& infrared, bool with_smooth, std::uint64_t seed, int shot,
        int num_threads) {
    const Camera& camera = infrared.camera();
    NoiseFields fields(camera, seed, shot, num_threads, measured_part(infrared));
    lateral_x = fields.next(3);
    lateral_y = fields.next(3);
    shared = fields.next(6);
    own = fields.next(0);
    match = fields.next(3);
    drop = fields.next(4);
    if (with_smooth) smooth = fields.next_of_all_shots(std::max(1, camera.width / 8));
  }
};

// Which pixel's surface answers at (x, y): edges are ragged.
int answering_pixel(const Measurement& m, const Noise& noise, double lateral_noise, int x, int y) {
  const int width = m.camera.width;
  const int i = y * width + x;
  const double bend =
      std::min(m.angle[i], 1.5f) / (std::numbers::pi / 2 - std::min(m.angle[i], 1.5f));
  const double lateral = lateral_noise * (0.8 + 0.035 * bend);
  const int u =
      std::clamp(x + static_cast<int>(std::lround(lateral * noise.lateral_x[i])), 0, width - 1);
  const int v = std::clamp(y + static_cast<int>(std::lround(lateral * noise.lateral_y[i])), 0,
                           m.camera.height - 1);
  const int j = v * width + u;
  return std::abs(m.disparity[j] - m.disparity[i]) > kSameDisparity ? j : i;
}

// Whether matching fails at (x, y), where the surface of pixel `source` answers.
bool drops_out(const Measurement& m, const Noise& noise, const KinectOptions& options, int x, int y,
               int source) {
  const auto dropouts = static_cast<float>(options.dropouts);
  if (dropouts <= 0) return false;
  const int i = y * m.camera.width + x;
  const auto gaps = static_cast<float>(options.edge_gaps);
  const float enough = gaps * (source != i ? kEnoughOfOther : kEnoughOfWindow);
  if (!window_agrees(m, x, y, m.disparity[source], enough + 0.06f * noise.match[i])) return true;
  constexpr float kWeakSignal = 0.032f;
  const float faint = 1 / (1 + std::pow(m.signal[source] / kWeakSignal, 6.0f));
  const float chance = dropouts * (0.0001f + faint + 0.9f * m.glare[source]);
  return 0.5f * std::erfc(-noise.drop[i] / std::numbers::sqrt2_v<float>) < chance;
}

// Steps 2 to 5 for one pixel: its depth, or 0.
float measure(const Measurement& m, const Noise& noise, const KinectOptions& options, int x,
              int y) {
  const int i = y * m.camera.width + x;
  const std::size_t source = answering_pixel(m, noise, options.lateral_noise, x, y);
  if (m.disparity[source] <= 0) return 0;
  if (drops_out(m, noise, options, x, y, source)) return 0;
  const double depth = m.depth[source];
  const double pixels_per_metre = m.disparity[source] / depth;
  const double wanted =
      options.axial_noise * published_axial_noise(depth, m.angle[source]) * pixels_per_metre;
  const double variance = wanted * wanted - options.disparity_step * options.disparity_step / 12;
  constexpr double kShared = 0.95;  // of the variance
  const double unit = std::sqrt(kShared) * noise.shared[i] + std::sqrt(1 - kShared) * noise.own[i];
  double disparity = m.disparity[source] +
                     (options.axial_noise > 0 ? std::sqrt(std::max(variance, 4e-4)) * unit : 0.0);
  if (options.calibration_error > 0) disparity += options.calibration_error * noise.smooth[i];
  if (options.disparity_step > 0) {
    disparity = options.disparity_step * std::round(disparity / options.disparity_step);
    if (disparity <= 0) return 0;
    return static_cast<float>(1e-3 * std::round(1e3 * m.disparity[source] * depth / disparity));
  }
  return static_cast<float>(m.disparity[source] * depth / disparity);
}

// Single pixels without an answer amid one surface take the nearest of their neighbours' depths, as
// the sensor's own clean-up does: real images have next to none of them.
std::vector<float> without_specks(const std::vector<float>& depth, const Camera& camera,
                                  double pixels_per_inverse) {
  constexpr int kEnoughNeighbours = 5;  // of 8
  const cv::Mat measured(camera.height, camera.width, CV_32F, const_cast<float*>(depth.data()));
  cv::Mat missing_far = measured.clone(), answers;
  missing_far.setTo(std::numeric_limits<float>::max(), measured <= 0);
  cv::Mat_<float> nearest, farthest;
  cv::erode(missing_far, nearest, {});  // of 3 x 3 pixels each
  cv::dilate(measured, farthest, {});
  cv::boxFilter((measured > 0) & 1, answers, CV_8U, {3, 3}, {-1, -1}, false);
  std::vector<float> result = depth;
  for (int y = 1; y + 1 < camera.height; ++y) {
    for (int x = 1; x + 1 < camera.width; ++x) {
      const float near = nearest(y, x);
      if (measured.at<float>(y, x) > 0 || answers.at<uchar>(y, x) < kEnoughNeighbours) continue;
      if (pixels_per_inverse * (1 / near - 1 / farthest(y, x)) > kSameDisparity) continue;
      result[y * camera.width + x] = near;
    }
  }
  return result;
}

}  // namespace

double published_axial_noise(double depth, double angle) {
  constexpr double kSteep = std::numbers::pi / 3;
  double sigma = 0.0012 + 0.0019 * (depth - 0.4) * (depth - 0.4);
  if (angle > kSteep) {
    const double left = std::max(std::numbers::pi / 2 - angle, 0.05);
    sigma += 0.0001 / std::sqrt(depth) * angle * angle / (left * left);
  }
  return sigma;
}

Frame simulate_depth(const SensorView& view, const KinectOptions& options, std::uint64_t seed,
                     int shot, int num_threads) {
  constexpr int kWidth = 640, kHeight = 480;  // of a Kinect's infrared image
  const InfraredCamera infrared = infrared_camera(view, kWidth, kHeight, options);
  const Measurement m = see(infrared, options, num_threads);
  const Noise noise(infrared, options.calibration_error > 0, seed, shot, num_threads);
  std::vector<float> depth(m.depth.size(), 0);
  for_each_pixel(m.camera, num_threads, [&](int x, int y, int i) {
    if (infrared.wanted(i)) depth[i] = measure(m, noise, options, x, y);
  });
  const double pixels_per_inverse = m.camera.fx * std::max(options.baseline, 1e-3);
  return depth_frame(view, m.camera, without_specks(depth, m.camera, pixels_per_inverse), options,
                     pixels_per_inverse);
}

}  // namespace bpa::sim
