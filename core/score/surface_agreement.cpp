// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/surface_agreement.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>

#include "core/base/dispatch.hpp"
#include "core/model/model_index.hpp"
#include "core/score/likelihood.hpp"
#include "core/score/projection.hpp"

namespace bpa::score {
namespace {

constexpr float kNormalSigma = 0.15f;   // radians: what poses and models are off by
constexpr float kTruncation = 4.5f;     // three standard deviations, squared and halved
constexpr float kSameDirection = 0.6f;  // cosine of normals on one surface
constexpr float kMinSlant = 0.3f;       // cosine; the sensor sees little of steeper surface
constexpr float kTurned = 0.8f;         // cosine up to which surface goes on beyond an edge

// Functions without branches and library calls, so that loops become vectors.
inline float lesser(float a, float b) { return a < b ? a : b; }
inline float greater(float a, float b) { return a > b ? a : b; }
inline float one_if(bool condition) { return condition ? 1.0f : 0.0f; }

// exp(x) for x <= 0, to 2e-6 of its value.
inline float exp_negative(float x) {
  constexpr float kLog2e = 1.44269504f, kLog2 = 0.69314718f;
  constexpr float kLeast = -80;  // below, the result is 0 to every sum here
  const float scaled = greater(x, kLeast) * kLog2e;
  const int whole = static_cast<int>(scaled - 0.5f);  // to the nearest
  const float r = (scaled - static_cast<float>(whole)) * kLog2;
  const float series =
      1 + r * (1 + r * (1 / 2.0f + r * (1 / 6.0f + r * (1 / 24.0f + r * (1 / 120.0f)))));
  return series * std::bit_cast<float>((whole + 127) << 23);
}

// acos(cosine) to 7e-5 radians (Abramowitz and Stegun, 4.4.45).
inline float acos_of(float cosine) {
  const float c = lesser(std::abs(cosine), 1);
  const float angle =
      std::sqrt(1 - c) * (1.5707288f + c * (-0.2121144f + c * (0.0742610f - c * 0.0187293f)));
  const float negative = one_if(cosine < 0);
  return angle + negative * (3.14159265f - 2 * angle);
}

// Where the model's surface points fall, and what is observed there.
struct SeenBlock {
  static constexpr int kSize = ViewBlock::kSize;
  float z[kSize];  // metres; 1 where a point faces away
  float normal[3][kSize], soft_normal[3][kSize];
  float slant[kSize];  // cosine of the angle between the normal and the line of sight
  int pixel[kSize];    // -1: outside the image, or facing away
  float facing[kSize], in_image[kSize], seen[kSize];  // 1 or 0; seen: a depth is known there
  float depth[kSize], observed[3][kSize];
  float noise_range[kSize], noise_normal[kSize];  // of the model, by edge distance and slant
};

// Straight-line code over arrays, so that the compiler uses the widest vectors there are.
BPA_DISPATCH void place_block(const CheckImage& image, const ViewBlock& model, const FastPose& pose,
                              int count, SeenBlock& __restrict out) {
  const Projection camera(image, pose);
  for (int k = 0; k < SeenBlock::kSize; ++k) {
    const Coordinates p = camera.moved(model.point[0][k], model.point[1][k], model.point[2][k]);
    const Coordinates n = camera.turned(model.normal[0][k], model.normal[1][k], model.normal[2][k]);
    const Coordinates soft =
        camera.turned(model.soft_normal[0][k], model.soft_normal[1][k], model.soft_normal[2][k]);
    const float slant =
        -(n.x * p.x + n.y * p.y + n.z * p.z) / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    out.normal[0][k] = n.x, out.normal[1][k] = n.y, out.normal[2][k] = n.z;
    out.soft_normal[0][k] = soft.x, out.soft_normal[1][k] = soft.y, out.soft_normal[2][k] = soft.z;
    const bool facing = (p.z > kNearest_m) & (slant >= kMinSlant) & (k < count);
    out.pixel[k] = camera.pixel_of(p, facing);
    out.facing[k] = one_if(facing);
    out.z[k] = facing ? p.z : 1;
    out.slant[k] = facing ? slant : 1;
  }
}

// Looks up what is observed at each point that faces the camera, and the noise there.
void look_up_block(const CheckImage& image, const NoiseTable& noise, const ViewBlock& model,
                   SeenBlock& block) {
  for (int k = 0; k < SeenBlock::kSize; ++k) {
    const bool inside = block.pixel[k] >= 0;
    const CheckPixel pixel =
        inside ? image.pixels[static_cast<std::size_t>(block.pixel[k])] : CheckPixel{};
    block.in_image[k] = one_if(inside);
    block.seen[k] = one_if(pixel.depth > 0);
    block.depth[k] = pixel.depth;
    for (int axis = 0; axis < 3; ++axis) block.observed[axis][k] = pixel.normal[axis];
    block.noise_range[k] = noise.range(model.edge_distance[k], block.slant[k]);
    block.noise_normal[k] = noise.normal(model.edge_distance[k], block.slant[k]);
  }
}

// Sums of what the points say, lane by lane: the same for any width of vectors.
struct Sums {
  using Lanes = std::array<float, ViewBlock::kSize>;
  Lanes facing{}, visible{}, unknown{}, agreeing{}, on_background{};  // numbers; agreeing weighted
  Lanes weight{}, range{}, normal{}, free{};
  Lanes expected{}, explained{};   // squared metres, seen from the front at one metre
  Lanes explained_points{};        // number
  std::array<Lanes, 6> normals{};  // of agreeing points, squared: xx, xy, xz, yy, yz, zz

  static double of(const Lanes& lanes) { return std::accumulate(lanes.begin(), lanes.end(), 0.0); }
};

// Adds the likelihoods of a block. `shows` receives whether a point's pixel shows the model.
BPA_DISPATCH void add_block(const CheckImage& image, float usual_noise, const ViewBlock& model,
                            const SeenBlock& block, Sums& __restrict sums,
                            float* __restrict shows) {
  const SensorNoise depth_noise = image.noise;
  const float pixel_size = 1 / image.fx;
  for (int k = 0; k < SeenBlock::kSize; ++k) {
    const float z = block.z[k], slant = block.slant[k], seen = block.seen[k];
    const float area = slant / (z * z);
    sums.facing[k] += block.facing[k];
    sums.expected[k] += block.facing[k] * area;
    sums.unknown[k] += block.in_image[k] - seen;

    // What the noise model says of the differences, standard deviations.
    const float noise = depth_noise(z);
    const float sensor = block.noise_range[k] * noise / usual_noise,
                off = tolerance::kPlacedSigma / slant;
    const float sigma_range = tolerance::depth_sigma(sensor, off);
    const float by_view = block.noise_normal[k] * block.noise_normal[k];
    const float sigma_normal =
        std::sqrt(greater(by_view, model.normal_variance[k]) + kNormalSigma * kNormalSigma);
    // The probability that the pixel of a point so far from a range edge of the view shows the
    // model and not what is behind it: the pixel is as large as it is, and the pose is a little
    // off.
    const float edge =
        lesser(model.edge_distance[k], 1) / (tolerance::kLateralSigma + z * pixel_size);
    const float inside = 1 - exp_negative(-edge * edge);

    const float difference = block.depth[k] - z;
    const float visible =
        seen * visibility_by_difference(difference, [](float x) { return exp_negative(x); });
    const float in_sight = one_if(visible > 0.5f);
    const float weight = visible * inside;
    sums.visible[k] += in_sight;
    sums.weight[k] += weight;
    const float deviation = difference / sigma_range;
    sums.range[k] -= weight * lesser(0.5f * deviation * deviation, kTruncation);
    // Beside a crease either the face's own normal is seen or the mean across the crease.
    const float ox = block.observed[0][k], oy = block.observed[1][k], oz = block.observed[2][k];
    const float nx = block.normal[0][k], ny = block.normal[1][k], nz = block.normal[2][k];
    const float hard = nx * ox + ny * oy + nz * oz;
    const float soft =
        block.soft_normal[0][k] * ox + block.soft_normal[1][k] * oy + block.soft_normal[2][k] * oz;
    const float cosine = greater(hard, soft) / 127;
    const float angle = acos_of(cosine) / sigma_normal;
    const float known = one_if(ox * ox + oy * oy + oz * oz > 0);
    sums.normal[k] -= weight * (known * lesser(0.5f * angle * angle, kTruncation) + 1 - known);
    sums.free[k] += weight * one_if(difference > tolerance::kApart(noise));
    // Depth errors along the ray grow with the slant of the surface.
    const float on_surface = seen *
                             one_if(std::abs(difference) * slant < tolerance::kOnSurface(noise)) *
                             one_if(cosine > kSameDirection);
    sums.agreeing[k] += weight * on_surface;
    sums.normals[0][k] += on_surface * nx * nx;
    sums.normals[1][k] += on_surface * nx * ny;
    sums.normals[2][k] += on_surface * nx * nz;
    sums.normals[3][k] += on_surface * ny * ny;
    sums.normals[4][k] += on_surface * ny * nz;
    sums.normals[5][k] += on_surface * nz * nz;
    const float shown = on_surface * in_sight;
    sums.explained[k] += shown * area;
    sums.explained_points[k] += shown;
    shows[k] = shown;
  }
}

Eigen::Matrix3f symmetric(const std::array<Sums::Lanes, 6>& lanes) {
  Eigen::Matrix3f out;
  int entry = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) {
      out(row, column) = out(column, row) = static_cast<float>(Sums::of(lanes[entry++]));
    }
  }
  return out;
}

// Where edge points and points beyond them fall, and the normals there.
struct SeenEdges {
  static constexpr int kSize = EdgeBlock::kSize;
  float z[kSize];                // metres
  float normal[3][kSize];        // camera frame
  int at[kSize], beyond[kSize];  // pixels; -1 outside the image
};

// Straight-line code over arrays, so that the compiler uses the widest vectors there are.
BPA_DISPATCH void place_edges(const CheckImage& image, const EdgeBlock& model, const FastPose& pose,
                              SeenEdges& __restrict out) {
  const Projection camera(image, pose);
  for (int k = 0; k < SeenEdges::kSize; ++k) {
    const Coordinates p = camera.moved(model.point[0][k], model.point[1][k], model.point[2][k]);
    const Coordinates n = camera.turned(model.normal[0][k], model.normal[1][k], model.normal[2][k]);
    const Coordinates outward =
        camera.turned(model.outward[0][k], model.outward[1][k], model.outward[2][k]);
    const Coordinates beyond{p.x + tolerance::kBeyondEdge * outward.x,
                             p.y + tolerance::kBeyondEdge * outward.y,
                             p.z + tolerance::kBeyondEdge * outward.z};
    out.z[k] = p.z;
    out.normal[0][k] = n.x, out.normal[1][k] = n.y, out.normal[2][k] = n.z;
    out.at[k] = camera.pixel_of(p, true);
    out.beyond[k] = camera.pixel_of(beyond, true);
  }
}

// Beyond a range edge of the model the observed surface must not simply go on: it may be further
// away, nearer (something in front), or turn (the object stands on it). Looks at the first `total`
// edge points of the sample.
void score_edges(const CheckImage& image, const ObjectModel& model, const ViewSample& sample,
                 std::size_t total, const FastPose& pose, SurfaceAgreement& out) {
  if (!model.complete) {  // has no edges to speak for or against it
    out.edge = 0;
    out.edge_support = 0.5;
    return;
  }
  int visible = 0, ends = 0, goes_on = 0;
  SeenEdges seen;
  for (std::size_t i = 0; i < total; ++i) {
    const std::size_t k = i % EdgeBlock::kSize;
    if (k == 0) place_edges(image, sample.edges[i / EdgeBlock::kSize], pose, seen);
    if (seen.at[k] < 0) continue;  // the image border hides it
    const float z = seen.z[k];
    const CheckPixel& inside = image.pixels[static_cast<std::size_t>(seen.at[k])];
    if (image.hides(inside.depth, z, tolerance::kGoesOn)) continue;
    ++visible;
    if (seen.beyond[k] < 0) continue;
    const CheckPixel& beyond = image.pixels[static_cast<std::size_t>(seen.beyond[k])];
    if (beyond.depth <= 0) continue;  // no depth: an edge shadow, neither for nor against
    // Where the model's tangent plane would be if the surface went on.
    const bool continues = std::abs(beyond.depth - z) < tolerance::kGoesOn(image.noise(z));
    const Eigen::Vector3f normal(seen.normal[0][k], seen.normal[1][k], seen.normal[2][k]);
    const bool turns = beyond.direction().dot(normal) < kTurned;
    (continues && !turns ? goes_on : ends) += 1;
  }
  const auto all = static_cast<double>(total);
  out.edge_visibility = total > 0 ? visible / all : 0;
  out.edge_support = total > 0 ? ends / all : 0;
  out.edge = visible > 0 ? -static_cast<double>(goes_on) / visible : -1;
}

// A view's points, block after block. Calls visit(model block, block as seen).
class ViewLook {
 public:
  ViewLook(const CheckImage& image, const ObjectModel& model, const FastPose& pose)
      : image_(image), model_(model), pose_(pose) {}

  // The first `count` points of a sample.
  void at(const ViewSample& sample, std::size_t count, const auto& visit) {
    for (std::size_t first = 0; first < count; first += ViewBlock::kSize) {
      look(sample.points[first / ViewBlock::kSize], count - first, visit);
    }
  }
  // All points.
  void at(const ModelView& view, const auto& visit) {
    ViewBlock block;
    for (std::size_t first = 0; first < view.visible.size(); first += ViewBlock::kSize) {
      const std::size_t left = view.visible.size() - first;
      const auto lanes = std::min<std::size_t>(left, ViewBlock::kSize);
      for (std::size_t k = 0; k < lanes; ++k) {
        block.set(static_cast<int>(k), view_point(model_, view, first + k));
      }
      look(block, left, visit);
    }
  }

 private:
  void look(const ViewBlock& block, std::size_t left, const auto& visit) {
    const auto count = static_cast<int>(std::min<std::size_t>(left, ViewBlock::kSize));
    place_block(image_, block, pose_, count, seen_);
    look_up_block(image_, model_.index->noise, block, seen_);
    visit(block, seen_);
  }

  const CheckImage& image_;
  const ObjectModel& model_;
  const FastPose& pose_;
  SeenBlock seen_;
};

}  // namespace

SurfaceAgreement measure_surface(const CheckImage& image, const ObjectModel& model,
                                 const Pose& pose, int max_points,
                                 std::vector<std::uint32_t>* explained) {
  constexpr std::size_t kAllEdges = 200, kMostEdges = 60;
  const FastPose fast = to_fast(pose);
  const ModelView& view = nearest_view(model.index->views, fast);
  const ViewSample& sample = sample_of(model, view);
  const std::size_t all = view.visible.size();
  const auto wanted = static_cast<std::size_t>(std::max(0, max_points));
  const bool whole = max_points <= 0 || wanted > sample.num_points;
  SurfaceAgreement out;
  Sums sums;
  const auto usual_noise = static_cast<float>(depth_noise(static_cast<float>(model.noise.depth)));
  const auto add = [&](const ViewBlock& block, const SeenBlock& seen) {
    float shows[ViewBlock::kSize];
    add_block(image, usual_noise, block, seen, sums, shows);
    for (int k = 0; k < ViewBlock::kSize; ++k) {
      if (shows[k] == 0) continue;
      const auto pixel = static_cast<std::uint32_t>(seen.pixel[k]);
      sums.on_background[k] += image.pixels[pixel].searched ? 0.0f : 1.0f;
      if (explained) explained->push_back(pixel);
    }
  };
  ViewLook look(image, model, fast);
  if (whole) {
    look.at(view, add);
  } else {
    look.at(sample, wanted, add);
  }
  // Each point stands for so much surface.
  const double share = whole ? 1 : static_cast<double>(all) / max_points;
  const double area = model.index->point_area * share;
  const double pixels = area * static_cast<double>(image.fx) * static_cast<double>(image.fy);
  out.expected_pixels = pixels * Sums::of(sums.expected);
  out.explained_pixels = pixels * Sums::of(sums.explained);
  out.explained_area = area * Sums::of(sums.explained_points);
  if (explained) {
    std::ranges::sort(*explained);
    explained->erase(std::unique(explained->begin(), explained->end()), explained->end());
  }
  out.relative_area = out.explained_area / (model.diameter * model.diameter);
  const double facing = Sums::of(sums.facing), weight = Sums::of(sums.weight);
  const double agreeing = Sums::of(sums.agreeing);
  if (facing > 0) {
    out.unknown = Sums::of(sums.unknown) / facing;
    out.visibility = Sums::of(sums.visible) / facing;
  }
  if (agreeing > 0) out.background = std::min(1.0, Sums::of(sums.on_background) / agreeing);
  if (weight > 1) {
    out.range = Sums::of(sums.range) / (kTruncation * weight);
    out.normal = Sums::of(sums.normal) / (kTruncation * weight);
    out.free_space = Sums::of(sums.free) / weight;
    out.agreeing = agreeing / weight;
    const Eigen::Matrix3f normals = symmetric(sums.normals);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(normals, Eigen::EigenvaluesOnly);
    const float trace = normals.trace();
    out.shape = trace > 0 ? static_cast<double>(solver.eigenvalues()[1] / trace) : 0;
  }
  // Of so many surface points, as many edge points.
  const std::size_t edges = max_points > 0 ? std::min(wanted, kMostEdges) : kAllEdges;
  score_edges(image, model, sample, std::min(edges, sample.num_edges), fast, out);
  return out;
}

std::vector<std::uint32_t> explained_pixels(const CheckImage& image, const ObjectModel& model,
                                            const Pose& pose) {
  std::vector<std::uint32_t> out;
  measure_surface(image, model, pose, 0, &out);
  return out;
}

HiddenPoints hidden_points(const CheckImage& image, const ObjectModel& model, const Pose& pose,
                           int max_points) {
  const FastPose fast = to_fast(pose);
  const ModelView& view = nearest_view(model.index->views, fast);
  const ViewSample& sample = sample_of(model, view);
  HiddenPoints out;
  ViewLook(image, model, fast)
      .at(sample, std::min<std::size_t>(sample.num_points, max_points),
          [&](const ViewBlock&, const SeenBlock& seen) {
            for (int k = 0; k < ViewBlock::kSize; ++k) {
              if (seen.pixel[k] < 0) continue;
              ++out.facing;
              if (image.hides(seen.depth[k], seen.z[k], tolerance::kGoesOn)) {
                out.pixels.push_back(static_cast<std::uint32_t>(seen.pixel[k]));
              }
            }
          });
  return out;
}

}  // namespace bpa::score
