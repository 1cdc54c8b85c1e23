// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/sim/sensor_view.hpp"

// What the simulated depth cameras share: what an infrared camera sees, random images, and the
// registration of depth to the colour camera.

namespace bpa::sim {

/// 0 up to `low`, 1 from `high` on, a cubic between them.
float smooth_step(float low, float high, float x);

/// What one ray from an infrared camera meets. World frame, metres.
struct InfraredHit {
  RayHit hit;                 ///< Its distance is the depth where the direction has z = 1.
  Eigen::Vector3f point;      ///< On the surface.
  Eigen::Vector3f lifted;     ///< Just above it: where rays start.
  Eigen::Vector3f to_camera;  ///< Unit length.
  float angle = 0;            ///< Of incidence, radians.

  /// The mirror-like share of light that `source` sends to the camera by this surface, in [0, 1].
  float glare(const Material& material, const Eigen::Vector3f& source) const;
};

/// An infrared camera in a scene.
class InfraredCamera {
 public:
  explicit InfraredCamera(const SensorView& view);

  const Camera& camera() const { return view_.camera; }
  const RayScene& scene() const { return view_.scene; }
  const Eigen::Vector3f& origin() const { return pose_.translation; }
  /// World frame; depth along it is distance along the optical axis.
  Eigen::Vector3f direction(int x, int y) const;
  /// Whether a pixel, by its index, is measured: SensorView::wanted.
  bool wanted(int pixel) const { return view_.wanted.empty() || view_.wanted[pixel] != 0; }
  /// A point `offset` metres to the right of the camera.
  Eigen::Vector3f beside(double offset) const;
  std::optional<InfraredHit> look(const Eigen::Vector3f& from,
                                  const Eigen::Vector3f& direction) const;
  /// The same of many directions from the camera, in their order.
  std::vector<std::optional<InfraredHit>> look(std::span<const Eigen::Vector3f> directions) const;
  /// Matt unless the scene says otherwise.
  Material material(const RayHit& hit) const;
  /// The share of infrared light that a surface returns: its material's, less where it looks dark.
  float reflectance(const RayHit& hit) const;
  /// How bright the surface looks where the ray meets it, in [0, 1].
  float brightness(const RayHit& hit) const;

 private:
  SensorView view_;
  FastPose pose_;
};

/// Where an infrared camera stands that is `color_x` metres to the left of the colour camera.
SensorView infrared_view(const SensorView& color, const Camera& infrared, double color_x);

/// The infrared camera of a sensor: its own of width x height pixels beside the colour camera, or
/// the view itself where depth is not `registered`. `options` are those of any depth camera.
InfraredCamera infrared_camera(const SensorView& view, int width, int height, const auto& options) {
  if (!options.registered) return InfraredCamera(view);
  const double focal = options.infrared_focal;
  const Camera own{width, height, focal, focal, 0.5 * (width - 1), 0.5 * (height - 1)};
  return InfraredCamera(infrared_view(view, own, options.color_baseline));
}

/// Row-major standard normal numbers, each of variance 1; with `radius` > 0 neighbours correlate:
/// white noise under a tent of half width `radius` + 1 pixels. The same for any number of threads.
/// Zero outside of `part`, if given, which saves time.
std::vector<float> noise_field(int width, int height, int radius, std::uint64_t seed,
                               int num_threads,
                               const std::optional<Eigen::AlignedBox2i>& part = {});

/// The seed of what differs from shot to shot.
std::uint64_t shot_seed(std::uint64_t seed, int shot);

/// The random images of one measurement, each of a stream of its own.
class NoiseFields {
 public:
  /// As noise_field(): only `part` of the images is needed.
  NoiseFields(const Camera& camera, std::uint64_t seed, int shot, int num_threads,
              const std::optional<Eigen::AlignedBox2i>& part = {})
      : camera_(camera), part_(part), seed_(seed), shot_(shot), num_threads_(num_threads) {}

  /// The next noise_field(); it differs from shot to shot.
  std::vector<float> next(int radius);
  /// The next one, the same in all shots.
  std::vector<float> next_of_all_shots(int radius);

 private:
  const Camera& camera_;
  std::optional<Eigen::AlignedBox2i> part_;
  std::uint64_t seed_, stream_ = 0;
  int shot_, num_threads_;
};

/// Depths at which inverse depths differ by less than 1 / this are of one surface: a pixel of a
/// Kinect's disparity, metres.
constexpr double kOneSurface = 42.8;

/// Registration: every measured pixel covers the colour pixels under it; the nearest wins. On one
/// surface it reaches half way to its neighbours in the row, so that a slope, which the other
/// viewpoint stretches, has no cracks. `same_surface` as kOneSurface.
std::vector<float> carried_over(const std::vector<float>& depth, const Camera& infrared,
                                const Camera& color, double color_x, double same_surface);

/// The frame of what the infrared camera measured, carried over to the view's where `registered`.
Frame depth_frame(const SensorView& view, const Camera& infrared, std::vector<float> depth,
                  const auto& options, double same_surface = kOneSurface) {
  Frame frame;
  frame.camera = view.camera;
  frame.depth = options.registered ? carried_over(depth, infrared, view.camera,
                                                  options.color_baseline, same_surface)
                                   : std::move(depth);
  return frame;
}

}  // namespace bpa::sim
