// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// A frame from depth image to interpretations: what is made once a frame, each stage of the search
// for one model, and the whole.
#include <memory>
#include <string>

#include <benchmark/benchmark.h>

#include "core/cloud/cielab.hpp"
#include "core/cloud/color_gradients.hpp"
#include "core/cloud/planes.hpp"
#include "core/detect/stages.hpp"
#include "core/modeling/model_source.hpp"
#include "core/pipeline/detector.hpp"
#include "core/sim/scenes.hpp"

namespace bpa {
namespace {

constexpr std::uint64_t kSeed = 1;

// A heap of twelve household objects seen by a Kinect, and models of three of them.
struct Heap {
  Frame frame;
  std::shared_ptr<ModelLibrary> library = std::make_shared<ModelLibrary>();
  std::shared_ptr<const ObjectModel> model;

  Heap() {
    const auto objects = sim::household_objects({"milk_carton", "mug", "bowl"});
    for (const sim::SimulatedObject& object : objects) {
      ModelSource source =
          modeling::model_source_from_mesh(object.mesh, object.name, kSeed).value();
      model = make_object_model(std::move(source)).value();
      benchmark::DoNotOptimize(library->add(model));
    }
    sim::SceneOptions options;
    options.min_objects = options.max_objects = 12;
    frame = sim::simulate_scene(sim::Stage(objects), options, kSeed).frames.front().frame;
  }

  SceneFeatures features() const {
    SurfaceMap map = surface_map(frame, {});
    auto planes = label_background_planes(map, {});
    ColorImages colors{reduced_color(frame, map, 0), color_gradients(frame, 0)};
    return scene_features(std::move(map), std::move(planes), {}, std::move(colors));
  }
};

const Heap& heap() {
  static const Heap heap;
  return heap;
}

const SceneFeatures& scene() {
  static const SceneFeatures scene = heap().features();
  return scene;
}

// Points, normals and curvatures.
void surface(benchmark::State& state) {
  const Frame& frame = heap().frame;
  for (auto _ : state) benchmark::DoNotOptimize(surface_map(frame, {}));
}
BENCHMARK(surface)->Name("cloud/surface_map")->UseRealTime()->Unit(benchmark::kMillisecond);

void fpfh(benchmark::State& state) {
  const SceneFeatures& s = scene();
  for (auto _ : state) {
    benchmark::DoNotOptimize(features::compute_fpfh(s.surface, s.keypoints, kFeatureRadius, 0));
  }
  state.counters["keypoints"] = static_cast<double>(s.keypoints.size());
}
BENCHMARK(fpfh)->Name("features/fpfh")->UseRealTime()->Unit(benchmark::kMillisecond);

// Votes of one model's point pairs.
void voting(benchmark::State& state) {
  const ModelIndex& index = *heap().model->index;
  const features::ScenePairs& pairs = scene().sample.pairs;
  const auto points = static_cast<int>(index.coarse.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(features::vote_poses(pairs, index.pairs, points, 1));
  }
}
BENCHMARK(voting)->Name("features/vote_poses")->Unit(benchmark::kMillisecond);

// One stage of the search for one model, on what the stages before it return.
void stage(benchmark::State& state, const detect::Stage* measured) {
  const detect::Search search(scene(), *heap().model, {}, score::default_score_layers(), {}, kSeed);
  detect::Candidates before;
  for (const detect::Stage* s = detect::detection_stages().data(); s != measured; ++s) {
    before = s->run(search, std::move(before));
  }
  for (auto _ : state) benchmark::DoNotOptimize(measured->run(search, before));
  state.counters["candidates"] = static_cast<double>(before.size());
}

void whole_frame(benchmark::State& state) {
  const Detector detector(heap().library, {});
  for (auto _ : state) benchmark::DoNotOptimize(detector.detect(heap().frame));
}
BENCHMARK(whole_frame)
    ->Name("pipeline/frame_of_three_models")
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

[[maybe_unused]] const bool registered = [] {
  for (const detect::Stage& s : detect::detection_stages()) {
    const std::string name = "detect/" + std::string(s.name);
    benchmark::RegisterBenchmark(name.c_str(), stage, &s)->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
}  // namespace bpa
