// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/search_tally.hpp"

#include <algorithm>

#include "core/eval/pose_errors.hpp"

namespace bpa::cli {

bool holds(const Interpretation& interpretation, const io::BopInstance& instance,
           const ObjectModel& model) {
  return std::ranges::any_of(interpretation.placements, [&](const Placement& placement) {
    return placement.model_number == instance.obj_id &&
           eval::is_right(placement.frame_from_object, instance.camera_from_object, model.symmetry);
  });
}

void RightPlacements::add(const std::vector<io::BopInstance>& truth,
                          const SceneInterpretations& result, const ModelLibrary& library,
                          double min_visible) {
  const Interpretation& best = result.interpretations.front();
  for (const Placement& placement : best.placements) {
    const auto model = library.find(placement.model);
    reported.hits += eval::is_right_about_any(placement.frame_from_object, *model, truth);
    ++reported.total;
  }
  for (const io::BopInstance& instance : truth) {
    const auto model = std::ranges::find(library.models(), instance.obj_id,
                                         [](const auto& m) { return m->number; });
    if (instance.visible_fraction < min_visible || model == library.models().end()) continue;
    const auto is_held = [&](const Interpretation& i) { return holds(i, instance, **model); };
    found.hits += is_held(best);
    found_in_twenty.hits += std::ranges::any_of(result.interpretations, is_held);
    ++found.total;
    ++found_in_twenty.total;
  }
}

void StageTimes::add(const std::string& stage, double milliseconds) {
  auto sum = std::ranges::find(sums_, stage, &StageTiming::stage);
  if (sum == sums_.end()) sum = sums_.insert(sum, {stage, 0});
  sum->milliseconds += milliseconds;
}

void StageTimes::add(const SceneInterpretations& result, const FrameTrace& trace) {
  ++frames_;
  for (const StageTiming& timing : result.timings) {
    if (timing.stage == "objects") {
      for (const detect::ObjectTrace& object : trace.objects) {
        for (const detect::TraceStage& stage : object.stages) {
          add("objects: " + std::string(stage.name), stage.milliseconds);
        }
      }
    }
    add(timing.stage, timing.milliseconds);
  }
  add("total", result.total_milliseconds);
}

std::vector<StageTiming> StageTimes::means() const {
  std::vector<StageTiming> means = sums_;
  for (StageTiming& mean : means) mean.milliseconds /= std::max(1, frames_);
  return means;
}

}  // namespace bpa::cli
