// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/private/infrared.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/random.hpp"

namespace bpa::sim {
namespace {

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

std::optional<InfraredHit> seen_along(const Eigen::Vector3f& from, const Eigen::Vector3f& direction,
                                      const std::optional<RayHit>& hit) {
  constexpr float kLift = 3e-4f;  // metres
  if (!hit) return std::nullopt;
  InfraredHit seen;
  seen.hit = *hit;
  seen.point = from + hit->distance * direction;
  seen.lifted = seen.point + kLift * hit->face_normal;
  seen.to_camera = -direction.normalized();
  seen.angle = std::acos(std::clamp(hit->normal.dot(seen.to_camera), 0.0f, 1.0f));
  return seen;
}

}  // namespace

float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

float InfraredHit::glare(const Material& material, const Eigen::Vector3f& source) const {
  const Eigen::Vector3f to_source = (source - point).normalized();
  const float facing = hit.normal.dot((to_camera + to_source).normalized());
  return smooth_step(0.25f, 1.0f, static_cast<float>(material.shine)) *
         smooth_step(0.965f, 0.998f, facing);
}

InfraredCamera::InfraredCamera(const SensorView& view)
    : view_(view), pose_(to_fast(view.world_from_camera)) {}

Eigen::Vector3f InfraredCamera::direction(int x, int y) const {
  return pose_.rotation * view_.camera.unproject(x, y, 1).cast<float>();
}

Eigen::Vector3f InfraredCamera::beside(double offset) const {
  return origin() + static_cast<float>(offset) * pose_.rotation.col(0);
}

std::optional<InfraredHit> InfraredCamera::look(const Eigen::Vector3f& from,
                                                const Eigen::Vector3f& direction) const {
  return seen_along(from, direction, view_.scene.cast(from, direction));
}

std::vector<std::optional<InfraredHit>> InfraredCamera::look(
    std::span<const Eigen::Vector3f> directions) const {
  const auto hits = view_.scene.cast(origin(), directions);
  std::vector<std::optional<InfraredHit>> seen(directions.size());
  for (std::size_t k = 0; k < seen.size(); ++k) {
    seen[k] = seen_along(origin(), directions[k], hits[k]);
  }
  return seen;
}

Material InfraredCamera::material(const RayHit& hit) const {
  return view_.shading.material(hit.instance, Material{});
}

float InfraredCamera::brightness(const RayHit& hit) const {
  const auto pixel = static_cast<float>(hit.distance / view_.camera.fx);
  return view_.scene.color(hit, pixel).sum() / 3;
}

float InfraredCamera::reflectance(const RayHit& hit) const {
  return static_cast<float>(material(hit).infrared) * (0.6f + 0.4f * brightness(hit));
}

SensorView infrared_view(const SensorView& color, const Camera& infrared, double color_x) {
  SensorView view = color;
  view.camera = infrared;
  view.world_from_camera =
      color.world_from_camera * Pose{Eigen::Quaterniond::Identity(), {-color_x, 0, 0}};
  return view;
}

std::vector<float> noise_field(int width, int height, int radius, std::uint64_t seed,
                               int num_threads, const std::optional<Eigen::AlignedBox2i>& part) {
  const std::vector<float> weights = tent(radius);
  const int taps = 2 * radius + 1;
  const Eigen::Vector2i first = part ? part->min() : Eigen::Vector2i::Zero();
  const Eigen::Vector2i last = part ? part->max() : Eigen::Vector2i(width - 1, height - 1);
  // White noise, smoothed along its rows as it is made. A row's numbers are drawn from its begin.
  std::vector<float> smooth_rows(width * (height + 2 * radius), 0);
  parallel_for(last.y() - first.y() + taps, num_threads, [&](int row) {
    const int y = first.y() + row;
    RandomStream random(seed, y);
    std::vector<float> white(last.x() + taps);
    for (float& value : white) value = static_cast<float>(random.normal());
    for (int x = first.x(); x <= last.x(); ++x) {
      float sum = 0;
      for (int t = 0; t < taps; ++t) sum += weights[t] * white[x + t];
      smooth_rows[y * width + x] = sum;
    }
  });
  if (radius == 0) return smooth_rows;
  std::vector<float> field(width * height, 0);
  parallel_for(last.y() - first.y() + 1, num_threads, [&](int row) {
    const int y = first.y() + row;
    for (int t = 0; t < taps; ++t) {
      for (int x = first.x(); x <= last.x(); ++x) {
        field[y * width + x] += weights[t] * smooth_rows[(y + t) * width + x];
      }
    }
  });
  return field;
}

std::uint64_t shot_seed(std::uint64_t seed, int shot) {
  return shot == 0 ? seed : RandomStream(seed, static_cast<std::uint64_t>(shot))();
}

std::vector<float> NoiseFields::next(int radius) {
  const std::uint64_t drawn = RandomStream(seed_, stream_++)();
  return noise_field(camera_.width, camera_.height, radius, shot_seed(drawn, shot_), num_threads_,
                     part_);
}

std::vector<float> NoiseFields::next_of_all_shots(int radius) {
  const std::uint64_t drawn = RandomStream(seed_, stream_++)();
  return noise_field(camera_.width, camera_.height, radius, drawn, num_threads_, part_);
}

std::vector<float> carried_over(const std::vector<float>& depth, const Camera& infrared,
                                const Camera& color, double color_x, double same_surface) {
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
      return same_surface * std::abs(1 / row[a] - 1 / row[b]) <= 1;
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

}  // namespace bpa::sim
