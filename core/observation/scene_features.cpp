// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/observation/scene_features.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <numeric>

#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/cloud/blur.hpp"
#include "core/cloud/cielab.hpp"
#include "core/cloud/curvature.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/model/model_index.hpp"

namespace bpa {
namespace {

PointCloud searched_points(const SurfaceMap& map) {
  PointCloud cloud;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!map.searched[i] || map.normals[i].squaredNorm() == 0) continue;
    cloud.points.push_back(map.points[i]);
    cloud.normals.push_back(map.normals[i]);
  }
  return cloud;
}

std::vector<int> shuffled(std::size_t count, std::uint64_t seed) {
  std::vector<int> all(count);
  std::iota(all.begin(), all.end(), 0);
  RandomStream random(seed, Stream::keypoints);
  for (std::size_t i = all.size(); i > 1; --i) {
    std::swap(all[i - 1], all[random.index(static_cast<int>(i))]);
  }
  return all;
}

// A random order of all points in which each cube of this edge gives one before any gives two.
std::vector<int> spread(std::span<const Eigen::Vector3f> points, std::uint64_t seed) {
  constexpr float kCube = tolerance::placed(10);  // chosen by hand
  std::vector<int> order = shuffled(points.size(), seed);
  std::map<std::array<int, 3>, int> given;  // by each cube
  std::vector<int> number(points.size());   // of a point in its cube
  for (const int i : order) {
    const Eigen::Vector3i cube = (points[i] / kCube).array().floor().cast<int>();
    number[i] = given[{cube.x(), cube.y(), cube.z()}]++;
  }
  std::ranges::stable_sort(order, {}, [&](int i) { return number[i]; });
  return order;
}

Image<Eigen::Vector3f> log_light_of(Image<Eigen::Vector3f> lab, int num_threads) {
  parallel_for(lab.size(), num_threads, [&](std::size_t i) { lab[i] = log_light(lab[i]); });
  return lab;
}

// The rims of the observed surface beside `points`: range edges and creases.
std::vector<features::RimPoint> scene_rims(const CheckImage& image, const PointCloud& points,
                                           int num_threads) {
  const auto look = [&](const Eigen::Vector3f& at, const Eigen::Vector3f& normal) {
    const int pixel = image.pixel_of(at);
    if (pixel < 0) return features::Beside::hidden;
    const CheckPixel& seen = image.pixels[static_cast<std::size_t>(pixel)];
    if (!(seen.depth > 0)) return features::Beside::unknown;
    const float near = tolerance::kBreaks(image.noise(at.z()));
    if (seen.depth < at.z() - near) return features::Beside::hidden;
    if (seen.depth > at.z() + near) return features::Beside::end;
    const Eigen::Vector3f there = seen.direction();
    return there.isZero() || there.dot(normal) > features::kSameFace ? features::Beside::surface
                                                                     : features::Beside::end;
  };
  return features::find_rims(points, look, num_threads);
}

std::shared_ptr<const SceneFeatures> with_flat_regions(const SceneFeatures& scene) {
  if (scene.flat.regions.empty()) return nullptr;
  auto out = std::make_shared<SceneFeatures>(scene);
  for (std::size_t i = 0; i < out->map.size(); ++i) {
    if (scene.flat.label[i] < 0) continue;
    out->map.searched[i] = out->image.pixels[i].searched = 1;
  }
  return out;
}

SceneFeatureOptions with_threads(SceneFeatureOptions options, int num_threads) {
  options.num_threads = options.edges.num_threads = options.segments.num_threads = num_threads;
  return options;
}

// What is made of images: edges, colours, super-pixels and flat regions.
void add_images(ColorImages colors, const SceneFeatureOptions& options, SceneFeatures& scene) {
  const Image<Eigen::Vector3f>& rgb = colors.reduced;
  const int threads = options.num_threads;
  scene.edges = features::scene_edges(scene.map, rgb, options.edges);
  Image<Eigen::Vector3f> sharp_lab;  // without blur
  if (!rgb.empty()) {
    sharp_lab = cielab(rgb, threads);
    add_colors(rgb, sharp_lab, options, scene);
  }
  scene.gradients = std::move(colors.gradients);
  scene.segmentation =
      segment::super_pixels(scene.map, scene.cielab, scene.edges.likelihood, options.segments);
  if (!options.use_flat_regions) return;
  // Pixels, against noise. The blur of `cielab` would smear thin objects.
  constexpr double kLittleBlur = 0.7;
  scene.flat = find_flat_regions(scene.map, scene.planes, blur(sharp_lab, kLittleBlur, threads));
}

// What hypotheses compare of colours.
void add_match_colors(int num_threads, SceneFeatures& scene) {
  if (scene.cielab.empty()) return;
  scene.match_colors = Image<MatchColor>(scene.cielab.width, scene.cielab.height, {});
  parallel_for(scene.cielab.size(), num_threads,
               [&](std::size_t i) { scene.match_colors[i] = match_color(scene.cielab[i]); });
  for (const Eigen::Vector3f& point : scene.coarse.points) {
    const int pixel = std::max(0, scene.image.pixel_of(point));  // a mean of points in the image
    scene.coarse_colors.push_back(scene.match_colors[static_cast<std::size_t>(pixel)]);
  }
}

// What is made of the searched points.
void add_points(const SceneFeatureOptions& options, SceneFeatures& scene) {
  const int threads = options.num_threads;
  const PointCloud searched = searched_points(scene.map);
  scene.surface = downsample(searched, kFeatureSpacing);
  scene.coarse = downsample(searched, static_cast<float>(options.coarse_spacing_m));
  estimate_curvature(scene.surface, kCurvatureRadius, threads);
  scene.keypoints = shuffled(scene.surface.size(), options.seed);
  scene.keypoints.resize(std::min<std::size_t>(scene.keypoints.size(), options.max_keypoints));
  scene.fpfh = features::compute_fpfh(scene.surface, scene.keypoints, kFeatureRadius, threads);
  scene.references = spread(scene.coarse.points, options.seed);
  scene.rims = scene_rims(scene.image, scene.coarse, threads);
  SampledSoFar passed;
  scene.sample = scene_sample(scene, next_points(scene, {}, options, passed), {}, options);
}

// Whether a point is on no pixel that is `explained`.
bool is_unexplained(const SceneFeatures& scene, std::span<const std::uint8_t> explained,
                    const Eigen::Vector3f& point) {
  const int pixel = scene.image.pixel_of(point);
  return explained.empty() || pixel < 0 || explained[pixel] == 0;
}

}  // namespace

void add_colors(const Image<Eigen::Vector3f>& rgb, const Image<Eigen::Vector3f>& sharp_lab,
                const SceneFeatureOptions& options, SceneFeatures& scene) {
  const int threads = options.num_threads;
  scene.cielab = cielab(blur(rgb, options.color_blur_px, threads), threads);
  if (options.use_texture) scene.log_light = log_light_of(scene.cielab, threads);
  if (options.use_outline) scene.sharp_light = log_light_of(sharp_lab, threads);
}

SamplePoints next_points(const SceneFeatures& scene, std::span<const std::uint8_t> explained,
                         const SceneFeatureOptions& options, SampledSoFar& passed) {
  SamplePoints out;
  std::size_t& k = passed.keypoints;
  for (; k < scene.keypoints.size() && std::ssize(out.keypoints) < options.round_keypoints; ++k) {
    if (is_unexplained(scene, explained, scene.surface.points[scene.keypoints[k]])) {
      out.keypoints.push_back(static_cast<int>(k));
    }
  }
  std::size_t& r = passed.references;
  for (; r < scene.references.size() && std::ssize(out.references) < options.max_references; ++r) {
    const int point = scene.references[r];
    if (is_unexplained(scene, explained, scene.coarse.points[point])) {
      out.references.push_back(point);
    }
  }
  return out;
}

SceneSample scene_sample(const SceneFeatures& scene, SamplePoints points,
                         std::span<const std::uint8_t> explained,
                         const SceneFeatureOptions& options) {
  std::vector<std::uint8_t> partners;
  for (const Eigen::Vector3f& point : scene.coarse.points) {
    partners.push_back(is_unexplained(scene, explained, point));
  }
  const auto reach = static_cast<float>(options.pair_reach_m);
  SceneSample out;
  out.pairs = features::scene_pairs(scene.coarse, points.references, reach, options.pair_step,
                                    options.num_threads, partners);
  out.rim_pairs = features::scene_rim_pairs(scene.coarse, scene.rims, points.references, reach,
                                            options.num_threads);
  out.points = std::move(points);
  return out;
}

SceneFeatures scene_features(SurfaceMap map, std::vector<Plane> planes,
                             const SceneFeatureOptions& options, ColorImages colors) {
  SceneFeatures scene;
  scene.image = make_check_image(map);
  scene.map = std::move(map);
  scene.planes = std::move(planes);
  run_both(
      options.num_threads,
      [&](int threads) { add_images(std::move(colors), with_threads(options, threads), scene); },
      [&](int threads) { add_points(with_threads(options, threads), scene); });
  add_match_colors(options.num_threads, scene);
  scene.with_flat = with_flat_regions(scene);
  return scene;
}

}  // namespace bpa
