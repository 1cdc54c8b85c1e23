// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/concat.hpp"
#include "core/base/stopwatch.hpp"
#include "core/pipeline/view_pool.hpp"
#include "core/scene/given_others.hpp"
#include "core/scene/interpretations.hpp"

namespace bpa {
namespace {

// Of a time budget, for the searches; the rest joins them. Chosen by hand.
constexpr double kTimeOfSearches = 0.75;

std::string name_of_view(std::size_t index, const std::string& frame_id) {
  return frame_id.empty() ? concat("views[", index, "]") : frame_id;
}

// The request as one camera sees it.
DetectRequest seen_from(const Pose& scene_from_camera, const DetectRequest& request) {
  const Pose camera_from_scene = scene_from_camera.inverse();
  DetectRequest out = request;
  out.on_round = {};
  for (PosePrior& prior : out.priors) prior = detect::transformed(camera_from_scene, prior);
  for (ExpectedPlacement& expected : out.expected) {
    expected.frame_from_object = camera_from_scene * expected.frame_from_object;
  }
  return out;
}

// Surfaces of the views in the fixed frame: how far they are apart, and where the cameras then are.
void check_cameras(std::span<const ViewSearch* const> views, const ViewsOptions& options,
                   ViewsResult& out) {
  std::vector<calibration::PosedSurface> surfaces;
  for (std::size_t v = 0; v < views.size(); ++v) {
    surfaces.push_back({&views[v]->scene.map, out.scene_from_camera[v]});
  }
  calibration::SurfaceAlignment alignment = calibration::align_surfaces(surfaces);
  for (const calibration::SurfaceDisagreement& pair : alignment.pairs) {
    const double degrees = pair.angle_rad * 180 / std::numbers::pi;
    if (pair.position_m < options.warn_position_m && degrees < options.warn_angle_deg) continue;
    out.warnings.push_back(calibration::disagreement_text(
        pair, name_of_view(pair.first, views[pair.first]->alone.frame_id),
        name_of_view(pair.second, views[pair.second]->alone.frame_id)));
  }
  out.disagreements = std::move(alignment.pairs);
  if (options.align_cameras) out.scene_from_camera = std::move(alignment.scene_from_camera);
}

// Of one view alone: its own interpretations, in the fixed frame.
SceneInterpretations moved(const SceneInterpretations& alone, const Pose& scene_from_camera) {
  SceneInterpretations out = alone;
  out.frame_id.clear();
  for (Interpretation& interpretation : out.interpretations) {
    for (Placement& placement : interpretation.placements) {
      placement = transformed(scene_from_camera, placement);
    }
  }
  return out;
}

// The request with the priors of all views, in the fixed frame.
DetectRequest with_priors_of(std::span<const View> views, const DetectRequest& request) {
  DetectRequest out = request;
  for (const View& view : views) {
    for (const PosePrior& prior : view.priors) {
      out.priors.push_back(detect::transformed(view.scene_from_camera, prior));
    }
  }
  return out;
}

// What all views together say of times, sensors and effort.
SceneInterpretations summed(std::span<const ViewSearch* const> views) {
  SceneInterpretations out;
  for (const ViewSearch* view : views) {
    const SceneInterpretations& alone = view->alone;
    out.stamp_ns = std::max(out.stamp_ns, alone.stamp_ns);
    out.budget_exhausted |= alone.budget_exhausted;
    for (const std::string& name : alone.not_searched) {
      if (std::ranges::count(out.not_searched, name) == 0) out.not_searched.push_back(name);
    }
    out.effort += alone.effort;
    out.fused_frames = std::max(out.fused_frames, alone.fused_frames);
    out.total_milliseconds += alone.total_milliseconds;
    if (out.sensor.empty()) out.sensor = alone.sensor;
    for (const StageTiming& timing : alone.timings) {
      const auto same = std::ranges::find(out.timings, timing.stage, &StageTiming::stage);
      if (same == out.timings.end()) {
        out.timings.push_back(timing);
      } else {
        same->milliseconds += timing.milliseconds;
      }
    }
  }
  return out;
}

Status check_views(std::span<const View> views) {
  if (views.empty() || views.size() > kMostViews) {
    return invalid_argument("there are ", views.size(), " views; there must be 1 to ", kMostViews);
  }
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (is_valid(views[v].scene_from_camera)) continue;
    return invalid_argument("views[", v,
                            "].scene_from_camera is no rigid motion: its numbers must ",
                            "be finite and its quaternion of unit length");
  }
  return {};
}

}  // namespace

double combined_log_odds(std::span<const ViewEvidence> views, const ViewsOptions& options) {
  double weight = 0, most = 0, sum = 0;
  double best = -std::numeric_limits<double>::infinity();
  for (const ViewEvidence& view : views) {
    weight += view.visibility;
    most = std::max(most, view.visibility);
    sum += view.visibility * (view.log_odds - options.empty_log_odds);
    best = std::max(best, view.log_odds);
  }
  if (!(most > 0)) return best;
  const double views_seen = weight / most;  // 1: one view alone
  return options.empty_log_odds + std::pow(views_seen, options.independence) * sum / weight;
}

Result<ViewSearch> search_view(const Detector& detector, const Frame& frame,
                               const DetectRequest& request, const RemoteSearch& elsewhere) {
  FrameTrace trace;
  Result<SceneInterpretations> alone = detector.detect(frame, request, &trace, elsewhere);
  if (!alone.ok()) return alone.status();
  return ViewSearch{std::move(trace.scene), std::move(trace.candidates), std::move(*alone)};
}

ViewsResult combine_views(const Detector& detector, std::span<const ViewSearch* const> views,
                          std::span<const Pose> scene_from_camera, const DetectRequest& request) {
  ViewsResult out;
  out.scene_from_camera.assign(scene_from_camera.begin(), scene_from_camera.end());
  if (views.size() == 1) {
    out.scene = moved(views.front()->alone, scene_from_camera.front());
    return out;
  }
  const ViewsOptions& options = detector.options().views;
  Stopwatch stage;
  out.scene = summed(views);
  const auto finish_stage = [&](const char* name) {
    out.scene.timings.push_back({name, stage.lap_milliseconds()});
    out.scene.total_milliseconds += out.scene.timings.back().milliseconds;
  };
  check_cameras(views, options, out);
  finish_stage("cameras");
  ViewPool pool(detector, views, out.scene_from_camera, request, options);
  pool.gather();
  pool.compare();
  detect::Candidates joined = pool.joined();
  const scene::Overlaps overlaps = pool.overlaps(joined);
  scene::let_compete(joined, overlaps);
  if (detector.options().scene.judge_given_others &&
      detector.options().detect.score.use_round_three) {
    pool.judge(scene::first_interpretation(joined, overlaps), overlaps);
    joined = pool.joined();
    scene::let_compete(joined, overlaps);
  }
  out.scene.effort += pool.effort();
  finish_stage("views");
  scene::InterpretationOptions interpretation = detector.options().scene;
  interpretation.seed = request.seed;
  out.scene.interpretations = interpret(joined, overlaps, pool.observed_pixels(), interpretation);
  scene::keep_best(out.scene.interpretations, request.top_k);
  finish_stage("interpretations of views");
  return out;
}

Result<ViewsResult> detect_views(const Detector& detector, std::span<const View> views,
                                 const DetectRequest& asked, const RemoteSearches& elsewhere) {
  if (Status status = check_views(views); !status.ok()) return status;
  const DetectRequest request = with_priors_of(views, asked);
  std::vector<ViewSearch> searches;
  std::vector<const ViewSearch*> pointers;
  std::vector<Pose> poses;
  const Deadline deadline =
      Deadline::after((views.size() > 1 ? kTimeOfSearches : 1) * request.budget_ms);
  for (std::size_t v = 0; v < views.size(); ++v) {
    DetectRequest of_view = seen_from(views[v].scene_from_camera, request);
    if (request.budget_ms > 0) {
      const auto left = static_cast<double>(views.size() - v);
      of_view.budget_ms = std::max(1.0, deadline.milliseconds_left() / left);
    }
    const Frame& frame = views[v].frame;
    Result<ViewSearch> search =
        search_view(detector, frame, of_view, elsewhere ? elsewhere(frame, of_view) : nullptr);
    if (!search.ok()) {
      return Status(search.status().code, concat("views[", v, "]: ", search.status().message));
    }
    searches.push_back(std::move(*search));
    poses.push_back(views[v].scene_from_camera);
  }
  for (const ViewSearch& search : searches) pointers.push_back(&search);
  return combine_views(detector, pointers, poses, request);
}

}  // namespace bpa
