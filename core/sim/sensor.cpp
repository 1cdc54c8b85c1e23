// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "core/base/random.hpp"
#include "core/sim/private/infrared.hpp"

namespace bpa::sim {
namespace {

// Exposure, white balance, a lens and a mosaic of filters (blur), noise that grows with light.
std::vector<std::uint8_t> photograph(const std::vector<std::uint8_t>& ideal, const Camera& camera,
                                     const ColorCameraOptions& options, std::uint64_t seed,
                                     int shot, int num_threads) {
  RandomStream random(seed, 0);
  const double exposure = 0.9 * std::exp(options.exposure_spread * random.normal());
  Eigen::Array3d gain;
  for (int c = 0; c < 3; ++c) {
    gain[c] = exposure * std::exp(options.white_balance_spread * random.normal());
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

Frame measure_depth(const SensorView& view, const SensorOptions& options, std::uint64_t seed,
                    int shot, int num_threads) {
  switch (options.kind) {
    case SensorKind::active_stereo:
      return simulate_depth(view, options.active_stereo, seed, shot, num_threads);
    case SensorKind::time_of_flight:
      return simulate_depth(view, options.time_of_flight, seed, shot, num_threads);
    case SensorKind::structured_light:
      break;
  }
  return simulate_depth(view, options.kinect, seed, shot, num_threads);
}

}  // namespace

SensorImage simulate_sensor(const SensorView& view, const SensorOptions& options,
                            std::uint64_t seed, int shot, int num_threads) {
  const auto render_by = [&](const Camera& camera) {
    return render(view.scene, camera, view.world_from_camera, view.shading, num_threads);
  };
  SensorImage image;
  image.frame = measure_depth(view, options, seed, shot, num_threads);
  image.ideal = render_by(view.camera);
  RandomStream random(seed, 100);
  Camera moved = view.camera;
  if (options.color.misregistration > 0) {
    const double direction = random.uniform(0, 2 * std::numbers::pi);
    moved.cx += options.color.misregistration * std::cos(direction);
    moved.cy += options.color.misregistration * std::sin(direction);
  }
  const std::vector<std::uint8_t> color =
      options.color.misregistration > 0 ? render_by(moved).color : image.ideal.color;
  image.frame.color = photograph(color, view.camera, options.color, random(), shot, num_threads);
  return image;
}

}  // namespace bpa::sim
