// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include <bpa/core/score/placement_score.hpp>

namespace bpa {
namespace {

constexpr float kVisibilitySigma = 0.01f;  // paper section V, footnote: 1 cm
constexpr float kNormalSigma = 0.35f;      // radians
constexpr float kTruncation = 4.5f;        // three standard deviations, squared and halved
constexpr float kModelSigma = 0.0025f;     // metres: what models and their poses are off by
constexpr float kOnSurface = 0.006f;       // metres, plus noise

struct Sums {
  double weight = 0, range = 0, normal = 0, free = 0, agreeing = 0;
  int facing = 0, visible = 0;
  Eigen::Matrix3f normals = Eigen::Matrix3f::Zero();  // of agreeing points, squared
};

float visibility_probability(float difference) {
  if (difference >= 0) return 1;  // the model is in front of what was observed, or on it
  const float z = difference / kVisibilitySigma;
  return std::exp(-0.5f * z * z);
}

struct Projection {
  Eigen::Vector3f point, normal;
  int u = -1, v = -1;
};

bool project(const CheckImage& image, const Eigen::Vector3f& point, int& u, int& v) {
  if (point.z() < 0.1f) return false;
  const float inverse_z = 1 / point.z();
  u = static_cast<int>(std::floor(image.fx * point.x() * inverse_z + image.cx + 0.5f));
  v = static_cast<int>(std::floor(image.fy * point.y() * inverse_z + image.cy + 0.5f));
  return u >= 0 && v >= 0 && u < image.width && v < image.height;
}

const CheckPixel& pixel_at(const CheckImage& image, int u, int v) {
  return image.pixels[static_cast<std::size_t>(v * image.width + u)];
}

Eigen::Vector3f normal_of(const CheckPixel& pixel) {
  return Eigen::Vector3f(pixel.normal[0], pixel.normal[1], pixel.normal[2]) / 127.0f;
}

// The pixel's part of the range and normal likelihoods.
void add_point(const CheckPixel& pixel, const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
               const Eigen::Vector3f& soft_normal, Sums& sums) {
  const float difference = pixel.depth - point.z();
  const float weight = visibility_probability(difference);
  sums.visible += weight > 0.5f;
  // Depth errors along the ray grow with the slant of the surface.
  const float slant = std::max(0.25f, -normal.dot(point) / point.norm());
  const float noise = depth_noise(point.z());
  const float sigma = std::sqrt(noise * noise + kModelSigma * kModelSigma) / slant;
  const float z = difference / sigma;
  sums.weight += weight;
  sums.range += weight * -std::min(0.5f * z * z, kTruncation);
  // Beside a crease either the face's own normal is seen or the mean across the crease.
  const Eigen::Vector3f observed = normal_of(pixel);
  const float cosine = std::max(normal.dot(observed), soft_normal.dot(observed));
  const float angle = std::acos(std::clamp(cosine, -1.0f, 1.0f)) / kNormalSigma;
  const bool known = pixel.normal[0] != 0 || pixel.normal[1] != 0 || pixel.normal[2] != 0;
  sums.normal += weight * (known ? -std::min(0.5f * angle * angle, kTruncation) : -1.0f);
  sums.free += weight * (difference > 0.02f);
  const bool on_surface = std::abs(difference) < (kOnSurface + 2 * noise) / slant && cosine > 0.6f;
  sums.agreeing += weight * on_surface;
  if (on_surface) sums.normals += normal * normal.transpose();
}

// Beyond a range edge of the model the observed surface must not simply go on: it may be further
// away, nearer (something in front), or turn (the object stands on it).
void score_edges(const CheckImage& image, const ObjectModel& model, const FastPose& pose,
                 ScoreComponents& out) {
  const Eigen::Vector3f to_camera = -(pose.rotation.transpose() * pose.translation).normalized();
  const auto& views = model.index->views;
  const ModelView& view = views[static_cast<std::size_t>(nearest_view(views, to_camera))];
  if (!model.complete) {  // has no edges to speak for or against it
    out.edge = 0;
    out.edge_support = 0.5;
    return;
  }
  const std::size_t step = std::max<std::size_t>(1, view.edges.size() / 200);
  int visible = 0, total = 0, ends = 0, goes_on = 0;
  for (std::size_t k = 0; k < view.edges.size(); k += step) {
    const std::uint32_t i = view.edges[k];
    const Eigen::Vector3f point = pose.rotation * model.surface.points[i] + pose.translation;
    const Eigen::Vector3f normal = pose.rotation * model.surface.normals[i];
    const Eigen::Vector3f outward = pose.rotation * view.outward[k];
    int u = 0, v = 0;
    if (!project(image, point, u, v)) continue;
    ++total;
    const CheckPixel& inside = pixel_at(image, u, v);
    if (inside.depth > 0 && inside.depth < point.z() - 0.015f) continue;  // hidden
    ++visible;
    int beyond_u = 0, beyond_v = 0;
    if (!project(image, point + 0.012f * outward, beyond_u, beyond_v)) continue;
    const CheckPixel& beyond = pixel_at(image, beyond_u, beyond_v);
    if (beyond.depth <= 0) continue;  // no depth: an edge shadow, neither for nor against
    // Where the model's tangent plane would be if the surface went on.
    const bool continues = std::abs(beyond.depth - point.z()) < 0.012f + 2 * depth_noise(point.z());
    const bool turns = normal_of(beyond).dot(normal) < 0.8f;
    (continues && !turns ? goes_on : ends) += 1;
  }
  out.edge_visibility = total > 0 ? static_cast<double>(visible) / total : 0;
  out.edge_support = total > 0 ? static_cast<double>(ends) / total : 0;
  out.edge = visible > 0 ? -static_cast<double>(goes_on) / visible : -1;
}

}  // namespace

ScoreComponents score_placement(const CheckImage& image, const ObjectModel& model, const Pose& pose,
                                std::vector<std::uint32_t>* explained) {
  const FastPose fast = to_fast(pose);
  const Eigen::Vector3f to_camera = -(fast.rotation.transpose() * fast.translation).normalized();
  const auto& views = model.index->views;
  const ModelView& view = views[static_cast<std::size_t>(nearest_view(views, to_camera))];
  ScoreComponents out;
  Sums sums;
  std::vector<std::uint32_t> on_model;
  std::vector<std::uint32_t> covered;
  for (std::uint32_t i : view.visible) {
    const Eigen::Vector3f point = fast.rotation * model.surface.points[i] + fast.translation;
    const Eigen::Vector3f normal = fast.rotation * model.surface.normals[i];
    if (normal.dot(point) > -0.3f * point.norm()) continue;
    int u = 0, v = 0;
    if (!project(image, point, u, v)) continue;
    ++sums.facing;
    const auto index = static_cast<std::uint32_t>(v * image.width + u);
    covered.push_back(index);
    const CheckPixel& pixel = image.pixels[index];
    if (pixel.depth <= 0) continue;
    const double before = sums.agreeing;
    add_point(pixel, point, normal, fast.rotation * model.index->soft_normals[i], sums);
    if (sums.agreeing > before + 0.5) on_model.push_back(index);
  }
  const auto unique = [](std::vector<std::uint32_t>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
  };
  unique(on_model);
  unique(covered);
  out.explained_pixels = static_cast<double>(on_model.size());
  out.expected_pixels = static_cast<double>(covered.size());
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
  score_edges(image, model, fast, out);
  if (explained) *explained = std::move(on_model);
  return out;
}

double placement_score(const ScoreComponents& c) {
  // Little visible surface carries little evidence, and one flat face less.
  const double evidence = std::clamp(std::log(std::max(1.0, c.explained_pixels) / 300), -2.0, 1.5);
  return -13.2 + 7 * c.agreeing + 10 * c.range + 6 * c.normal - 6 * c.free_space + 20 * c.edge +
         3 * std::min(1.0, c.edge_support / 0.5) + 2 * std::min(1.0, c.visibility / 0.6) +
         1.5 * evidence + 1.5 * std::min(1.0, c.shape / 0.05);
}

double placement_probability(const ScoreComponents& components) {
  return 1 / (1 + std::exp(-placement_score(components)));
}

}  // namespace bpa
