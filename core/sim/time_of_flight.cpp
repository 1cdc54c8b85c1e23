// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/time_of_flight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/sim/private/infrared.hpp"

namespace bpa::sim {
namespace {

using Phasor = std::complex<float>;

constexpr float kFullLight = 0.56f;        // share of light that the published noise is for
constexpr float kWeakAmplitude = 0.0067f;  // 0.1 at 3.86 m
constexpr float kLeastCoherence = 0.8f;    // of the mixed phasors; less has no depth
constexpr int kBounceStep = 6;             // pixels between those whose bounces are summed
constexpr int kBounceRays = 32;
constexpr double kLightSpeed = 299792458;  // metres per second

// What a pixel sees before anything is mixed.
struct LitPixel {
  float depth = 0;     // metres; 0 where there is nothing
  float range = 0;     // metres along the ray
  float angle = 0;     // of incidence, radians
  float returned = 0;  // share of light: reflectance times cosine
  float glare = 0;     // in [0, 1]
  Eigen::Vector3f point, lifted, normal;

  float amplitude() const { return range > 0 ? returned / (range * range) : 0; }
};

struct LitImage {
  Camera camera;
  float radians_per_metre = 0;  // of range
  std::vector<LitPixel> pixels;

  const LitPixel& at(int x, int y) const {
    return pixels[std::clamp(y, 0, camera.height - 1) * camera.width +
                  std::clamp(x, 0, camera.width - 1)];
  }
};

// Step 1.
LitImage see(const InfraredCamera& infrared, const TimeOfFlightOptions& options, int num_threads) {
  LitImage m{infrared.camera(),
             static_cast<float>(4 * std::numbers::pi * options.modulation_hz / kLightSpeed),
             {}};
  m.pixels.resize(static_cast<std::size_t>(m.camera.width) * m.camera.height);
  for_each_pixel(m.camera, num_threads, [&](int x, int y, int i) {
    const Eigen::Vector3f direction = infrared.direction(x, y);
    const auto seen = infrared.look(infrared.origin(), direction);
    if (!seen) return;
    const float z = seen->hit.distance;
    LitPixel& pixel = m.pixels[i];
    pixel = {z,
             z * direction.norm(),
             seen->angle,
             infrared.reflectance(seen->hit) * std::cos(seen->angle),
             seen->glare(infrared.material(seen->hit), infrared.origin()),
             seen->point,
             seen->lifted,
             seen->hit.normal};
  });
  return m;
}

// Unit vectors about z, as many as their cosine asks for (Hammersley points).
std::array<Eigen::Vector3f, kBounceRays> cosine_directions() {
  std::array<Eigen::Vector3f, kBounceRays> out;
  for (int k = 0; k < kBounceRays; ++k) {
    float turn = 0, digit = 0.5f;
    for (int bits = k; bits > 0; bits >>= 1, digit /= 2)
      turn += digit * static_cast<float>(bits & 1);
    const float squared = (static_cast<float>(k) + 0.5f) / kBounceRays;
    const float angle = 2 * std::numbers::pi_v<float> * turn, radius = std::sqrt(squared);
    out[k] = {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - squared)};
  }
  return out;
}

// Step 2 for one pixel: the phasor of the light of one bounce, over that of the direct light.
Phasor bounce(const InfraredCamera& infrared, const LitImage& m, const LitPixel& pixel,
              const std::array<Eigen::Vector3f, kBounceRays>& directions) {
  const Eigen::Vector3f& normal = pixel.normal;
  const Eigen::Vector3f side = normal.unitOrthogonal(), other = normal.cross(side);
  Phasor sum = 0;
  for (const Eigen::Vector3f& d : directions) {
    const Eigen::Vector3f direction = d.x() * side + d.y() * other + d.z() * normal;
    const auto hit = infrared.look(pixel.lifted, direction);
    if (!hit) continue;
    const Eigen::Vector3f to_light = infrared.origin() - hit->point;
    const float range = to_light.norm();
    const float facing = hit->hit.normal.dot(to_light) / range;
    if (facing <= 0 || infrared.scene().blocked(hit->lifted, infrared.origin())) continue;
    const float light = infrared.reflectance(hit->hit) * facing / (range * range);
    const float longer = 0.5f * (range + hit->hit.distance - pixel.range);
    sum += std::polar(light, m.radians_per_metre * longer);
  }
  const float direct = std::max(std::cos(pixel.angle), 0.05f) / (pixel.range * pixel.range);
  return sum / (kBounceRays * direct);
}

// Step 2 for every pixel: of bounces at pixels kBounceStep apart, those of the same surface.
std::vector<Phasor> bounces(const InfraredCamera& infrared, const LitImage& m, int num_threads) {
  constexpr float kSameNormal = 0.9f, kSamePlane = 0.01f;  // cosine; metres
  const auto directions = cosine_directions();
  const Camera grid{m.camera.width / kBounceStep + 1, m.camera.height / kBounceStep + 1};
  std::vector<Phasor> nodes(static_cast<std::size_t>(grid.width) * grid.height);
  const auto pixel_of = [&](int column, int row) -> const LitPixel& {
    return m.at(column * kBounceStep, row * kBounceStep);
  };
  for_each_pixel(grid, num_threads, [&](int column, int row, int i) {
    const LitPixel& pixel = pixel_of(column, row);
    if (pixel.depth > 0) nodes[i] = bounce(infrared, m, pixel, directions);
  });
  std::vector<Phasor> all(m.pixels.size());
  for_each_pixel(m.camera, num_threads, [&](int x, int y, int i) {
    const LitPixel& pixel = m.pixels[i];
    if (pixel.depth <= 0) return;
    Phasor sum = 0;
    float weights = 0;
    for (int row = y / kBounceStep; row <= std::min(y / kBounceStep + 1, grid.height - 1); ++row) {
      for (int column = x / kBounceStep; column <= std::min(x / kBounceStep + 1, grid.width - 1);
           ++column) {
        const LitPixel& node = pixel_of(column, row);
        const bool same = node.depth > 0 && node.normal.dot(pixel.normal) > kSameNormal &&
                          std::abs(pixel.normal.dot(node.point - pixel.point)) < kSamePlane;
        if (!same) continue;
        const auto away_x = static_cast<float>(std::abs(column * kBounceStep - x)) / kBounceStep;
        const auto away_y = static_cast<float>(std::abs(row * kBounceStep - y)) / kBounceStep;
        const float weight = (1.01f - away_x) * (1.01f - away_y);
        sum += weight * nodes[row * grid.width + column];
        weights += weight;
      }
    }
    all[i] = weights > 0 ? sum / weights : bounce(infrared, m, pixel, directions);
  });
  return all;
}

// The light of a pixel with all that mixes into it, relative to its own phase.
struct Mixed {
  Phasor phasor = 0;
  float amplitude = 0;  // if all had one phase
};

// Step 3.
Mixed mix(const LitImage& m, const std::vector<Phasor>& bounced, bool flying_pixels, int x, int y) {
  constexpr float kWeights[] = {0.25f, 0.5f, 0.25f};
  const LitPixel& own = m.at(x, y);
  Mixed mixed;
  const auto add = [&](int u, int v, float weight) {
    if (u < 0 || v < 0 || u >= m.camera.width || v >= m.camera.height) return;
    const LitPixel& pixel = m.at(u, v);
    if (pixel.depth <= 0) return;
    const Phasor light = 1.0f + (bounced.empty() ? Phasor(0) : bounced[v * m.camera.width + u]);
    const float phase = m.radians_per_metre * (pixel.range - own.range);
    mixed.phasor += light * std::polar(weight * pixel.amplitude(), phase);
    mixed.amplitude += weight * pixel.amplitude() * std::abs(light);
  };
  if (!flying_pixels) {
    add(x, y, 1);
    return mixed;
  }
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) add(x + du, y + dv, kWeights[du + 1] * kWeights[dv + 1]);
  }
  return mixed;
}

struct FlightNoise {
  std::vector<float> own, drop;

  FlightNoise(const Camera& camera, std::uint64_t seed, int shot, int num_threads) {
    NoiseFields fields(camera, seed, shot, num_threads);
    own = fields.next(0);
    drop = fields.next(1);
  }
};

// Steps 3 to 5 for one pixel: its depth, or 0.
float measure(const LitImage& m, const std::vector<Phasor>& bounced, const FlightNoise& noise,
              const TimeOfFlightOptions& options, int x, int y) {
  const int i = y * m.camera.width + x;
  const LitPixel& own = m.pixels[i];
  if (own.depth <= 0) return 0;
  const Mixed mixed = mix(m, bounced, options.flying_pixels, x, y);
  const float amplitude = std::abs(mixed.phasor);
  if (!(amplitude > 0)) return 0;
  const double faint = 1 / (1 + std::pow(amplitude / kWeakAmplitude, 6.0));
  const bool cancelled = amplitude < kLeastCoherence * mixed.amplitude;
  const double chance = options.dropouts * (0.0001 + faint + 0.9 * own.glare + cancelled);
  if (0.5 * std::erfc(-noise.drop[i] / std::numbers::sqrt2) < chance) return 0;
  const float along = own.depth / own.range;
  const float off = std::arg(mixed.phasor) / m.radians_per_metre;
  const double full = kFullLight * std::cos(own.angle);
  const double share = amplitude * own.range * own.range / std::max(full, 0.02);
  const double sigma = options.axial_noise * published_axial_noise(options, own.depth, own.angle) /
                       std::sqrt(std::max(share, 0.05));
  const double depth = own.depth + along * off + sigma * noise.own[i];
  if (depth < options.min_range || depth > options.max_range) return 0;
  return static_cast<float>(options.axial_noise > 0 ? 1e-3 * std::round(1e3 * depth) : depth);
}

}  // namespace

double published_axial_noise(const TimeOfFlightOptions&, double depth, double angle) {
  const double left = std::max(std::numbers::pi / 2 - angle, 0.05);
  return 1e-3 * (1.5 - 0.5 * depth + 0.3 * depth * depth +
                 0.1 * std::pow(depth, 1.5) * angle * angle / (left * left));
}

Frame simulate_depth(const SensorView& view, const TimeOfFlightOptions& options, std::uint64_t seed,
                     int shot, int num_threads) {
  const InfraredCamera infrared = infrared_camera(view, options.width, options.height, options);
  const LitImage m = see(infrared, options, num_threads);
  std::vector<Phasor> bounced;
  if (options.multipath > 0) {
    bounced = bounces(infrared, m, num_threads);
    for (Phasor& phasor : bounced) phasor *= static_cast<float>(options.multipath);
  }
  const FlightNoise noise(m.camera, seed, shot, num_threads);
  std::vector<float> depth(m.pixels.size(), 0);
  for_each_pixel(m.camera, num_threads, [&](int x, int y, int i) {
    depth[i] = measure(m, bounced, noise, options, x, y);
  });
  return depth_frame(view, m.camera, std::move(depth), options);
}

}  // namespace bpa::sim
