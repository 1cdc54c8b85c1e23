// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>

#include <benchmark/benchmark.h>

#include "core/base/random.hpp"
#include "core/cloud/cielab.hpp"
#include "core/features/edges.hpp"
#include "core/modeling/model_source.hpp"
#include "core/score/boundary_scores.hpp"
#include "core/score/color_score.hpp"
#include "core/score/random_walk_score.hpp"
#include "core/score/segment_scores.hpp"
#include "tests/support/meshes.hpp"

namespace bpa {
namespace {

const Eigen::Vector3f kHalf(0.09f, 0.06f, 0.04f);

// A box with its long face toward the camera, 0.9 m away, before a wall.
Frame box_before_wall() {
  Frame frame;
  frame.camera = {640, 480, 525, 525, 319.5, 239.5};
  RandomStream random(1);
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const Eigen::Vector3d at = frame.camera.unproject(u, v, 0.9);
      const bool box = std::abs(at.x()) < 0.09 && std::abs(at.y()) < 0.06;
      frame.depth.push_back(static_cast<float>((box ? 0.9 : 1.1) + 0.002 * random.normal()));
      for (int k = 0; k < 3; ++k) frame.color.push_back(box ? 200 : 90);
    }
  }
  return frame;
}

std::shared_ptr<const ObjectModel> box_model() {
  ModelSource source = modeling::model_source_from_mesh(test::box_mesh(kHalf), "box", 1).value();
  source.surface.colors.assign(source.surface.size(), {200, 200, 200});
  return make_object_model(std::move(source)).value();
}

// What the prediction and the components that use it take for one placement.
void round_three(benchmark::State& state) {
  const auto model = box_model();
  const Frame frame = box_before_wall();
  const SurfaceMap map = surface_map(frame, {});
  const CheckImage image = make_check_image(map);
  const auto rgb = reduced_color(frame, map, 0);
  const auto lab = cielab(rgb, 0);
  const Image<float> edges = features::scene_edges(map, rgb).likelihood;
  const segment::Segmentation segments = segment::super_pixels(map, lab, edges);
  const auto& model_lab = model->index->cielab;
  const Pose pose{Eigen::Quaterniond::Identity(), {0, 0, 0.9 + static_cast<double>(kHalf.z())}};
  for (auto _ : state) {
    const score::PredictedSurface predicted = score::predict_surface(image, *model, pose);
    double sum = score::edge_likelihood_score(image, edges, *model, pose);
    sum += score::occlusion_edge_score(image, edges, predicted);
    sum += score::random_walk_score(image, edges, *model, pose, predicted);
    const auto matches = score::match_segments(segments, map, *model, pose, predicted);
    sum += score::segment_score(matches) + score::segment_affinity_score(segments, matches);
    sum += score::compare_colors(image, lab, model_lab, predicted).likelihood;
    benchmark::DoNotOptimize(sum);
  }
}
BENCHMARK(round_three)->Name("score/round_three")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace bpa
