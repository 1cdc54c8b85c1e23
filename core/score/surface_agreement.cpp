// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/surface_agreement.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <span>

#include "core/model/model_index.hpp"
#include "core/score/likelihood.hpp"

namespace bpa {
namespace {

constexpr float kNormalSigma = 0.15f;    // radians: what poses and models are off by
constexpr float kLateralSigma = 0.003f;  // metres, beside a pixel: the same across the view
constexpr float kTruncation = 4.5f;      // three standard deviations, squared and halved
constexpr float kModelSigma = 0.0025f;   // metres: what models and their poses are off by
constexpr float kOnSurface = 0.006f;     // metres, plus noise
constexpr float kMinSlant = 0.3f;        // cosine; the sensor sees little of steeper surface
// Beside model edges: metres in front that hide, metres beyond the edge that are looked at, metres
// and cosine up to which surface goes on.
constexpr float kHiding = 0.015f, kBeyond = 0.012f, kGoesOn = 0.012f, kTurned = 0.8f;

struct Sums {
  double weight = 0, range = 0, normal = 0, free = 0, agreeing = 0;
  double background = 0;
  int facing = 0, visible = 0, unknown = 0;
  Eigen::Matrix3f normals = Eigen::Matrix3f::Zero();  // of agreeing points, squared
};

// The probability that the pixel of a point so far from a range edge of the view shows the model
// and not what is behind it: the pixel is as large as it is, and the pose is a little off.
float inside_probability(float edge_distance, float pixel_size) {
  const float z = edge_distance / (kLateralSigma + pixel_size);
  return 1 - std::exp(-z * z);
}

// What the noise model says of a point's differences, standard deviations.
struct PointNoise {
  float inside = 1;  // the probability that its pixel shows the model
  float range = 0;   // metres along the ray
  float normal = 0;  // radians
};

// A surface point as the camera sees it.
struct SeenPoint {
  Eigen::Vector3f point, normal, soft_normal;
  std::size_t pixel = 0;
  float slant = 0;  // cosine of the angle between the normal and the line of sight
  PointNoise noise;
};

// Adds the pixel's part of the likelihoods; true when it shows the model's surface.
bool add_point(const CheckImage& image, const SeenPoint& seen, Sums& sums) {
  const CheckPixel& pixel = image.pixels[seen.pixel];
  const Eigen::Vector3f& point = seen.point;
  const Eigen::Vector3f& normal = seen.normal;
  const float difference = pixel.depth - point.z();
  const float visible = visibility_probability(pixel.depth, point.z());
  const float weight = visible * seen.noise.inside;
  sums.visible += visible > 0.5f;
  // Depth errors along the ray grow with the slant of the surface.
  const float slant = std::max(0.25f, seen.slant);
  const float noise = image.noise(point.z());
  const float z = difference / seen.noise.range;
  sums.weight += weight;
  sums.range += weight * -std::min(0.5f * z * z, kTruncation);
  // Beside a crease either the face's own normal is seen or the mean across the crease.
  const Eigen::Vector3f observed = pixel.direction();
  const float cosine = std::max(normal.dot(observed), seen.soft_normal.dot(observed));
  const float angle = std::acos(std::clamp(cosine, -1.0f, 1.0f)) / seen.noise.normal;
  const bool known = pixel.normal[0] != 0 || pixel.normal[1] != 0 || pixel.normal[2] != 0;
  sums.normal += weight * (known ? -std::min(0.5f * angle * angle, kTruncation) : -1.0f);
  sums.free += weight * (difference > 0.02f);
  const bool on_surface = std::abs(difference) < (kOnSurface + 2 * noise) / slant && cosine > 0.6f;
  sums.agreeing += weight * on_surface;
  if (on_surface) sums.normals += normal * normal.transpose();
  return on_surface && visible > 0.5f;
}

// Beyond a range edge of the model the observed surface must not simply go on: it may be further
// away, nearer (something in front), or turn (the object stands on it).
void score_edges(const CheckImage& image, const ObjectModel& model, std::span<const ViewEdge> edges,
                 const FastPose& pose, SurfaceAgreement& out) {
  if (!model.complete) {  // has no edges to speak for or against it
    out.edge = 0;
    out.edge_support = 0.5;
    return;
  }
  int visible = 0, total = 0, ends = 0, goes_on = 0;
  for (const ViewEdge& edge : edges) {
    const Eigen::Vector3f point = pose * edge.point;
    const Eigen::Vector3f normal = pose.rotation * edge.normal;
    const Eigen::Vector3f outward = pose.rotation * edge.outward;
    const int at = image.pixel_of(point);
    ++total;
    if (at < 0) continue;  // the image border hides it
    const CheckPixel& inside = image.pixels[static_cast<std::size_t>(at)];
    if (hides(inside.depth, point.z(), kHiding)) continue;
    ++visible;
    const int at_beyond = image.pixel_of(point + kBeyond * outward);
    if (at_beyond < 0) continue;
    const CheckPixel& beyond = image.pixels[static_cast<std::size_t>(at_beyond)];
    if (beyond.depth <= 0) continue;  // no depth: an edge shadow, neither for nor against
    // Where the model's tangent plane would be if the surface went on.
    const bool continues =
        std::abs(beyond.depth - point.z()) < kGoesOn + 2 * image.noise(point.z());
    const bool turns = beyond.direction().dot(normal) < kTurned;
    (continues && !turns ? goes_on : ends) += 1;
  }
  out.edge_visibility = total > 0 ? static_cast<double>(visible) / total : 0;
  out.edge_support = total > 0 ? static_cast<double>(ends) / total : 0;
  out.edge = visible > 0 ? -static_cast<double>(goes_on) / visible : -1;
}

// Position, normal and slant. False where the point faces away or is behind the camera.
bool place_point(const ViewPoint& of_model, const FastPose& pose, SeenPoint& out) {
  out.point = pose * of_model.point;
  out.normal = pose.rotation * of_model.normal;
  out.slant = -out.normal.dot(out.point) / out.point.norm();
  return out.point.z() > kNearest_m && out.slant >= kMinSlant;
}

// The rest of a placed point; false outside the image.
bool see_placed(const CheckImage& image, const ObjectModel& model, const ViewPoint& of_model,
                const FastPose& pose, SeenPoint& out) {
  const int pixel = image.pixel_of(out.point);
  if (pixel < 0) return false;
  out.pixel = static_cast<std::size_t>(pixel);
  out.soft_normal = pose.rotation * of_model.soft_normal;
  const float edge_distance = of_model.edge_distance;
  const NoiseTable& noise = model.index->noise;
  const float sensor = noise.range(edge_distance, out.slant) * image.noise(out.point.z()) /
                       depth_noise(static_cast<float>(model.noise.depth));
  const float off = kModelSigma / out.slant;
  out.noise.range = std::sqrt(sensor * sensor + off * off);
  const float normal = noise.normal(edge_distance, out.slant);
  out.noise.normal =
      std::sqrt(std::max(normal * normal, of_model.normal_variance) + kNormalSigma * kNormalSigma);
  out.noise.inside = inside_probability(edge_distance, out.point.z() / image.fx);
  return true;
}

// Adds every point of a view. Each of them stands for `share` surface points.
void add_points(const CheckImage& image, const ObjectModel& model, const FastPose& pose,
                double share, std::size_t count, const auto& point_at, Sums& sums,
                SurfaceAgreement& out, std::vector<std::uint32_t>* explained) {
  // Pixels that a point's surface covers, seen from the front at one metre.
  const double area = model.index->point_area * share;
  const double pixels_per_point = area * static_cast<double>(image.fx) * image.fy;
  SeenPoint seen;
  for (std::size_t k = 0; k < count; ++k) {
    const ViewPoint& of_model = point_at(k);
    if (!place_point(of_model, pose, seen)) continue;
    ++sums.facing;
    const double z = seen.point.z();
    const double covered = pixels_per_point * seen.slant / (z * z);
    out.expected_pixels += covered;
    if (!see_placed(image, model, of_model, pose, seen)) continue;  // the image border hides it
    const CheckPixel& pixel = image.pixels[seen.pixel];
    if (pixel.depth <= 0) {
      ++sums.unknown;
      continue;
    }
    if (add_point(image, seen, sums)) {
      out.explained_pixels += covered;
      out.explained_area += area;
      sums.background += pixel.searched ? 0 : 1;
      if (explained) explained->push_back(static_cast<std::uint32_t>(seen.pixel));
    }
  }
}

std::size_t index_of(const ObjectModel& model, const ModelView& view) {
  return static_cast<std::size_t>(&view - model.index->views.data());
}

}  // namespace

SurfaceAgreement measure_surface(const CheckImage& image, const ObjectModel& model,
                                 const Pose& pose, int max_points,
                                 std::vector<std::uint32_t>* explained) {
  constexpr std::size_t kAllEdges = 200, kMostEdges = 60;
  const FastPose fast = to_fast(pose);
  const ModelView& view = nearest_view(model.index->views, fast);
  const ViewSample& sample = model.view_samples[index_of(model, view)];
  const std::size_t all = view.visible.size();
  const auto wanted = static_cast<std::size_t>(std::max(0, max_points));
  SurfaceAgreement out;
  Sums sums;
  if (max_points <= 0 || wanted > sample.points.size()) {
    add_points(
        image, model, fast, 1, all, [&](std::size_t k) { return view_point(model, view, k); }, sums,
        out, explained);
  } else {
    add_points(
        image, model, fast, static_cast<double>(all) / max_points, wanted,
        [&](std::size_t k) -> const ViewPoint& { return sample.points[k]; }, sums, out, explained);
  }
  if (explained) {
    std::ranges::sort(*explained);
    explained->erase(std::ranges::unique(*explained).begin(), explained->end());
  }
  out.relative_area = out.explained_area / (model.diameter * model.diameter);
  out.unknown = sums.facing > 0 ? static_cast<double>(sums.unknown) / sums.facing : 0;
  if (sums.agreeing > 0) out.background = std::min(1.0, sums.background / sums.agreeing);
  if (sums.weight > 1) {
    out.range = sums.range / (kTruncation * sums.weight);
    out.normal = sums.normal / (kTruncation * sums.weight);
    out.free_space = sums.free / sums.weight;
    out.agreeing = sums.agreeing / sums.weight;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(sums.normals);
    const float trace = sums.normals.trace();
    out.shape = trace > 0 ? static_cast<double>(solver.eigenvalues()[1] / trace) : 0;
  }
  out.visibility = sums.facing > 0 ? static_cast<double>(sums.visible) / sums.facing : 0;
  // Of so many surface points, as many edge points.
  const std::size_t edges = max_points > 0 ? std::min(wanted, kMostEdges) : kAllEdges;
  score_edges(image, model, std::span(sample.edges).first(std::min(edges, sample.edges.size())),
              fast, out);
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
  const std::span<const ViewPoint> points = model.view_samples[index_of(model, view)].points;
  HiddenPoints out;
  SeenPoint seen;
  for (const ViewPoint& point : points.first(std::min<std::size_t>(points.size(), max_points))) {
    if (!place_point(point, fast, seen) || !see_placed(image, model, point, fast, seen)) continue;
    ++out.facing;
    if (hides(image.pixels[seen.pixel].depth, seen.point.z(), kHiding)) {
      out.pixels.push_back(static_cast<std::uint32_t>(seen.pixel));
    }
  }
  return out;
}

}  // namespace bpa
