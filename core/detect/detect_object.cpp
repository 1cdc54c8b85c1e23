// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>

#include "core/base/stopwatch.hpp"
#include "core/detect/stages.hpp"

namespace bpa {
namespace {

constexpr Stage kStages[] = {
    {"sampled", sample, 0.3, "Sampled",
     "Poses drawn by BPA from single FPFH matches, voted for by oriented point pairs, and drawn "
     "from priors."},
    {"free_space", check_free_space, 0.4, "Checked against the depth image",
     "Poses with over 20 % of their points in free space are rejected, and poses without surface. "
     "The best few of each place stay and get a first small correction."},
    {"clusters", cluster, 1, "Clustered",
     "Poses within 2.5 cm and pi/16 are a cluster. BPA aligns each one again with the "
     "correspondences of all its poses."},
    {"round_two", round_two, 0.5, "Aligned (round two)",
     "BPA and Gauss-Newton steps move each pose onto the surface around it. A step is accepted if "
     "the score improves."},
    {"aligned", refine, 0.5, "Refined",
     "After non-maximum suppression the best are aligned once more and scored with all components "
     "(round three)."},
    {"climbed", climb, 0.5, "Climbed",
     "The best climb the score by small steps, from where they are and from beside."},
    {"turned", try_turned, 0.7, "Turned",
     "The best are tried in near-symmetric poses, those that the view may leave open."},
    {"laid", lay_flat, 0.7, "Laid flat",
     "A thin model is laid onto regions that differ from their plane, where its silhouette agrees "
     "best."},
    {"rivals", compare_rivals, 1, "Compared",
     "Poses in one place are compared on the pixels where they disagree."},
    {"final", select, 1, "Selected",
     "Distinct placements of sufficient score. Interpretations of the scene choose from these."},
};

// Runs a stage and records what came of it.
Candidates traced(const Stage& stage, Search& search, Candidates candidates, ObjectTrace* trace) {
  if (!trace) return stage.run(search, std::move(candidates));
  trace->stages.push_back({stage.name, stage.title, stage.text, {}, 0, {}});
  search.tracing = &trace->stages.back();
  const Stopwatch watch;
  candidates = stage.run(search, std::move(candidates));
  search.tracing->milliseconds = watch.milliseconds();
  for (const Candidate& c : candidates) search.tracing->poses.push_back(to_fast(c.pose()));
  return candidates;
}

}  // namespace

std::span<const Stage> detection_stages() { return kStages; }

Candidates detect_object(Search search, ObjectTrace* trace) {
  const Deadline deadline = search.deadline;
  Candidates found;
  for (const Stage& stage : kStages) {
    search.deadline = deadline.part(stage.time_share);
    found = traced(stage, search, std::move(found), trace);
  }
  return found;
}

void TraceStage::reject(std::string_view reason, const FastPose& pose) {
  auto found = std::ranges::find(rejected, reason, &Rejected::reason);
  if (found == rejected.end()) found = rejected.insert(found, {reason, {}});
  found->poses.push_back(pose);
}

}  // namespace bpa
