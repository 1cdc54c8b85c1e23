// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/kinect.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/geometry/pose.hpp"

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

float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

// Steps 1 and 3.
Measurement see(const KinectView& infrared, const KinectOptions& options, int num_threads) {
  const std::vector<float> zeros(infrared.camera.width * infrared.camera.height, 0);
  Measurement m{infrared.camera, zeros, zeros, zeros, zeros, zeros};
  const FastPose world_from_camera = to_fast(infrared.world_from_camera);
  const Eigen::Matrix3f& rotation = world_from_camera.rotation;
  const Eigen::Vector3f& origin = world_from_camera.translation;
  const Eigen::Vector3f projector = origin + static_cast<float>(options.baseline) * rotation.col(0);
  for_each_pixel(m.camera, num_threads, [&](int x, int y, int i) {
    const Eigen::Vector3f direction = rotation * m.camera.unproject(x, y, 1).cast<float>();
    const std::optional<RayHit> hit = infrared.scene.cast(origin, direction);
    if (!hit || hit->distance < options.min_range || hit->distance > options.max_range) return;
    const Eigen::Vector3f point = origin + hit->distance * direction;
    const Eigen::Vector3f to_camera = -direction.normalized();
    const Eigen::Vector3f to_projector = (projector - point).normalized();
    const float lit = hit->face_normal.dot(to_projector);
    m.depth[i] = hit->distance;
    m.angle[i] = std::acos(std::clamp(hit->normal.dot(to_camera), 0.0f, 1.0f));
    const Eigen::Vector3f lifted = point + 3e-4f * hit->face_normal;
    if (options.shadows && (lit <= 0 || infrared.scene.blocked(lifted, projector))) return;
    const Material material = infrared.shading.material(hit->instance, Material{});
    const auto pixel = static_cast<float>(hit->distance / m.camera.fx);
    const float brightness = infrared.scene.color(*hit, pixel).sum() / 3;
    const auto shine = static_cast<float>(material.shine);
    const float away = 1 - 0.6f * shine * m.angle[i] / (std::numbers::pi_v<float> / 2);
    m.signal[i] = static_cast<float>(material.infrared) * (0.6f + 0.4f * brightness) *
                  std::sqrt(std::max(lit, 0.0f)) * away / std::pow(hit->distance, 1.5f);
    const float facing = hit->normal.dot((to_camera + to_projector).normalized());
    m.glare[i] = smooth_step(0.25f, 1.0f, shine) * smooth_step(0.965f, 0.998f, facing);
    m.disparity[i] =
        static_cast<float>(m.camera.fx * std::max(options.baseline, 1e-3) / hit->distance);
  });
  return m;
}

// The share of the matching window round (x, y) that is lit and has about this disparity.
float window_agreement(const Measurement& m, int x, int y, float disparity) {
  int agree = 0;
  for (int v = std::max(y - kWindow, 0); v <= std::min(y + kWindow, m.camera.height - 1); ++v) {
    const float* row = m.disparity.data() + v * m.camera.width;
    for (int u = std::max(x - kWindow, 0); u <= std::min(x + kWindow, m.camera.width - 1); ++u) {
      agree += std::abs(row[u] - disparity) <= kSameDisparity;
    }
  }
  return static_cast<float>(agree) / ((2 * kWindow + 1) * (2 * kWindow + 1));
}

// A tent whose squares sum to 1, so that variances stay 1.
std::vector<float> tent(int radius) {
  std::vector<float> weights;
  double squares = 0;
  for (int i = -radius; i <= radius; ++i) {
    const double w = radius + 1 - std::abs(i);
    weights.push_back(static_cast<float>(w));
    squares += w * w;
  }
  for (float& w : weights) w /= static_cast<float>(std::sqrt(squares));
  return weights;
}

// Row-major standard normal numbers, each of variance 1; with `radius` > 0 neighbours correlate:
// white noise under a tent of half width `radius` + 1 pixels. The same for any number of threads.
std::vector<float> noise_field(int width, int height, int radius, std::uint64_t seed,
                               int num_threads) {
  const std::vector<float> weights = tent(radius);
  const int taps = 2 * radius + 1, padded_height = height + 2 * radius;
  // White noise, smoothed along its rows as it is made.
  std::vector<float> smooth_rows(width * padded_height);
  parallel_for(padded_height, num_threads, [&](int y) {
    RandomStream random(seed, y);
    std::vector<float> white(width + 2 * radius);
    for (float& value : white) value = static_cast<float>(random.normal());
    for (int x = 0; x < width; ++x) {
      float sum = 0;
      for (int t = 0; t < taps; ++t) sum += weights[t] * white[x + t];
      smooth_rows[y * width + x] = sum;
    }
  });
  if (radius == 0) return smooth_rows;
  std::vector<float> field(width * height, 0);
  parallel_for(height, num_threads, [&](int y) {
    for (int t = 0; t < taps; ++t) {
      for (int x = 0; x < width; ++x) {
        field[y * width + x] += weights[t] * smooth_rows[(y + t) * width + x];
      }
    }
  });
  return field;
}

// The seed of what differs from shot to shot.
std::uint64_t shot_seed(std::uint64_t seed, int shot) {
  return shot == 0 ? seed : RandomStream(seed, static_cast<std::uint64_t>(shot))();
}

// The random images that the measurement draws on.
struct Noise {
  std::vector<float> lateral_x, lateral_y, shared, own, match, drop, smooth;

  Noise(const Camera& camera, bool with_smooth, std::uint64_t seed, int shot, int num_threads) {
    std::uint64_t stream = 0;
    const auto make = [&](int radius, bool always_so = false) {
      const std::uint64_t drawn = RandomStream(seed, stream++)();
      return noise_field(camera.width, camera.height, radius,
                         always_so ? drawn : shot_seed(drawn, shot), num_threads);
    };
    lateral_x = make(3);
    lateral_y = make(3);
    shared = make(6);
    own = make(0);
    match = make(3);
    drop = make(4);
    if (with_smooth) smooth = make(std::max(1, camera.width / 8), true);
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
  if (window_agreement(m, x, y, m.disparity[source]) < enough + 0.06f * noise.match[i]) return true;
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

// Step 6: every measured pixel covers the colour pixels under it; the nearest wins. On one surface
// (disparities within a pixel) it reaches half way to its neighbours in the row, so that a slope,
// which the other viewpoint stretches, has no cracks.
std::vector<float> carried_over(const std::vector<float>& depth, const Camera& infrared,
                                const Camera& color, double color_x, double pixels_per_inverse) {
  std::vector<float> result(color.width * color.height, 0);
  const double half_x = std::max(0.5 * color.fx / infrared.fx, 0.5);
  const double half_y = std::max(0.5 * color.fy / infrared.fy, 0.5);
  const auto column = [&](int x, float z) {
    return color.project(infrared.unproject(x, 0, z) - Eigen::Vector3d(color_x, 0, 0)).x();
  };
  const auto first = [](double p) { return std::max(static_cast<int>(std::ceil(p - 1e-9)), 0); };
  const auto last = [](double p, int size) {
    return std::min(static_cast<int>(std::floor(p - 1e-6)), size - 1);
  };
  for (int y = 0; y < infrared.height; ++y) {
    const float* row = depth.data() + y * infrared.width;
    const auto joined = [&](int a, int b) {
      if (b < 0 || b >= infrared.width || row[b] <= 0) return false;
      return pixels_per_inverse * std::abs(1 / row[a] - 1 / row[b]) <= kSameDisparity;
    };
    for (int x = 0; x < infrared.width; ++x) {
      const float z = row[x];
      if (z <= 0) continue;
      const double u0 = column(x, z), v0 = color.project(infrared.unproject(x, y, z)).y();
      double left = u0 - half_x, right = u0 + half_x;
      if (joined(x, x - 1)) left = std::min(left, 0.5 * (u0 + column(x - 1, row[x - 1])));
      if (joined(x, x + 1)) right = std::max(right, 0.5 * (u0 + column(x + 1, row[x + 1])));
      for (int v = first(v0 - half_y); v <= last(v0 + half_y, color.height); ++v) {
        for (int u = first(left); u <= last(right, color.width); ++u) {
          float& target = result[v * color.width + u];
          if (target == 0 || z < target) target = z;
        }
      }
    }
  }
  return result;
}

// Exposure, white balance, a lens and a mosaic of filters (blur), noise that grows with light.
std::vector<std::uint8_t> photograph(const std::vector<std::uint8_t>& ideal, const Camera& camera,
                                     const KinectOptions& options, std::uint64_t seed, int shot,
                                     int num_threads) {
  RandomStream random(seed, 0);
  const double exposure = 0.9 * std::exp(options.exposure_spread * random.normal());
  Eigen::Array3d gain;
  for (int c = 0; c < 3; ++c) {
    gain[c] = exposure * std::exp(0.3 * options.exposure_spread * random.normal());
  }
  const auto draw_field = [&] {
    return noise_field(camera.width, camera.height, 1, shot_seed(random(), shot), num_threads);
  };
  const std::array<std::vector<float>, 3> noise{draw_field(), draw_field(), draw_field()};
  cv::Mat blurred;
  cv::Mat(camera.height, camera.width, CV_8UC3, const_cast<std::uint8_t*>(ideal.data()))
      .convertTo(blurred, CV_32F);
  cv::GaussianBlur(blurred, blurred, {3, 3}, 0, 0, cv::BORDER_REPLICATE);  // binomial: exact
  std::vector<std::uint8_t> image(ideal.size());
  for_each_pixel(camera, num_threads, [&](int x, int y, int i) {
    for (int c = 0; c < 3; ++c) {
      const double light = gain[c] * blurred.at<cv::Vec3f>(y, x)[c];
      const double sigma = options.color_noise * std::sqrt(6 + 0.12 * light);
      const double value = light + sigma * noise[c][i];
      image[3 * i + c] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    }
  });
  return image;
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

Frame simulate_depth(const KinectView& view, const KinectOptions& options, std::uint64_t seed,
                     int shot, int num_threads) {
  KinectView infrared = view;
  if (options.registered) {
    infrared.camera = {640, 480, options.infrared_focal, options.infrared_focal, 319.5, 239.5};
    infrared.world_from_camera = view.world_from_camera * Pose{Eigen::Quaterniond::Identity(),
                                                               {-options.color_baseline, 0, 0}};
  }
  const Measurement m = see(infrared, options, num_threads);
  const Noise noise(m.camera, options.calibration_error > 0, seed, shot, num_threads);
  std::vector<float> depth(m.depth.size(), 0);
  for_each_pixel(m.camera, num_threads,
                 [&](int x, int y, int i) { depth[i] = measure(m, noise, options, x, y); });
  const double pixels_per_inverse = m.camera.fx * std::max(options.baseline, 1e-3);
  depth = without_specks(depth, m.camera, pixels_per_inverse);
  Frame frame;
  frame.camera = view.camera;
  frame.depth = options.registered ? carried_over(depth, m.camera, view.camera,
                                                  options.color_baseline, pixels_per_inverse)
                                   : std::move(depth);
  return frame;
}

KinectImage simulate_kinect(const KinectView& view, const KinectOptions& options,
                            std::uint64_t seed, int shot, int num_threads) {
  const auto render_by = [&](const Camera& camera) {
    return render(view.scene, camera, view.world_from_camera, view.shading, num_threads);
  };
  KinectImage image;
  image.frame = simulate_depth(view, options, seed, shot, num_threads);
  image.ideal = render_by(view.camera);
  RandomStream random(seed, 100);
  Camera moved = view.camera;
  if (options.misregistration > 0) {
    const double direction = random.uniform(0, 2 * std::numbers::pi);
    moved.cx += options.misregistration * std::cos(direction);
    moved.cy += options.misregistration * std::sin(direction);
  }
  const std::vector<std::uint8_t> color =
      options.misregistration > 0 ? render_by(moved).color : image.ideal.color;
  image.frame.color = photograph(color, view.camera, options, random(), shot, num_threads);
  return image;
}

}  // namespace bpa::sim
