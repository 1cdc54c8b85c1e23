// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/prepare_scene.hpp"

#include <utility>

#include "core/base/parallel.hpp"
#include "core/cloud/cielab.hpp"
#include "core/cloud/color_gradients.hpp"

namespace bpa {

SceneFeatures prepare_scene(const Frame& frame, const SearchPlan& plan, const Deadline& deadline,
                            std::vector<StageTiming>& timings) {
  SceneFeatureOptions features = plan.features;
  // With a budget, the search draws the first sample, as large as the time left allows.
  if (plan.limited) features.max_references = features.round_keypoints = 0;
  Stopwatch stage;
  const auto finish_stage = [&](const char* name) {
    timings.push_back({name, stage.lap_milliseconds()});
  };
  SurfaceMap map = surface_map(frame, plan.surface);
  finish_stage("surface");
  if (!details_fit(timings.back().milliseconds, deadline.milliseconds_left())) {
    leave_out_details(features);
  }
  std::vector<Plane> planes;
  ColorImages colors;
  run_both(
      plan.features.num_threads,
      [&](int threads) {
        if (features.use_color) colors.reduced = reduced_color(frame, map, threads);
        if (features.use_outline) colors.gradients = color_gradients(frame, threads);
      },
      [&](int) {
        if (frame.background.empty()) planes = label_background_planes(map, plan.planes);
      });
  finish_stage("planes");
  SceneFeatures scene =
      scene_features(std::move(map), std::move(planes), features, std::move(colors));
  finish_stage("features");
  return scene;
}

}  // namespace bpa
