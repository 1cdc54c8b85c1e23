// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/prepare_scene.hpp"

#include <utility>

#include "core/base/parallel.hpp"
#include "core/cloud/cielab.hpp"
#include "core/cloud/color_gradients.hpp"
#include "core/pipeline/search_plan.hpp"

namespace bpa {

SceneFeatures prepare_scene(const Frame& frame, const DetectRequest& request,
                            DetectorOptions options, const Deadline& deadline,
                            std::vector<StageTiming>& timings) {
  options.surface.num_threads = options.features.num_threads = request.num_threads;
  options.planes.seed = options.features.seed = request.seed;
  // With a budget, the search draws the first sample, as large as the time left allows.
  if (request.budget_ms > 0) options.features.max_references = options.features.round_keypoints = 0;
  Stopwatch stage;
  const auto finish_stage = [&](const char* name) {
    timings.push_back({name, stage.lap_milliseconds()});
  };
  SurfaceMap map = surface_map(frame, options.surface);
  finish_stage("surface");
  if (!details_fit(timings.back().milliseconds, deadline.milliseconds_left())) {
    leave_out_details(options.features);
  }
  std::vector<Plane> planes;
  ColorImages colors;
  run_both(
      request.num_threads,
      [&](int threads) {
        if (!options.features.use_color) return;
        colors.reduced = reduced_color(frame, map, threads);
        if (options.features.use_outline) colors.gradients = color_gradients(frame, threads);
      },
      [&](int) {
        if (frame.background.empty()) planes = label_background_planes(map, options.planes);
      });
  finish_stage("planes");
  SceneFeatures scene =
      scene_features(std::move(map), std::move(planes), options.features, std::move(colors));
  finish_stage("features");
  return scene;
}

}  // namespace bpa
