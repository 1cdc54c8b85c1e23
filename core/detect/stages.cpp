// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0

#include "core/detect/stages.hpp"

#include <algorithm>
#include <atomic>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "core/base/parallel.hpp"
#include "core/base/stopwatch.hpp"

namespace bpa::detect {
namespace {

constexpr Stage kStages[] = {
    {"sample", sample,
     "Poses drawn by BPA from single FPFH matches, voted for by oriented point pairs, and drawn "
     "from priors."},
    {"check", check,
     "Poses with over 20 % of their points in free space are rejected, and poses without surface. "
     "The best of each place by score stay, then the best of all models.",
     [](const DetectPlan& plan) { return plan.check.max_in_library; },
     score::Limit::checked_behind},
    {"correct", correct,
     "Two Gauss-Newton steps move each pose onto the surface, where that improves it."},
    {"cluster", cluster,
     "Poses within 2.5 cm and pi/16 are a cluster. BPA aligns each one again with the "
     "correspondences of all its poses. The best of all models go on.",
     [](const DetectPlan& plan) { return plan.cluster.max_in_library; },
     score::Limit::clustered_behind},
    {"round_two", round_two,
     "BPA and Gauss-Newton steps move each pose onto the surface around it. A step is accepted if "
     "the score improves. After non-maximum suppression the best of all models go on.",
     [](const DetectPlan& plan) { return plan.round_two.max_in_library; },
     score::Limit::aligned_behind},
    {"refine", refine,
     "The best are aligned once more by gradients. Non-maximum suppression follows.", nullptr,
     score::Limit::refined_behind},
    {"score", score, "Each is scored with all components (round three)."},
    {"climb", climb,
     "The best climb the score by small steps, from where they are and from beside."},
    {"turn", turn,
     "The best are tried in near-symmetric poses, those that the view may leave open."},
    {"lay", lay,
     "A thin model is laid onto regions that differ from their plane, where its silhouette agrees "
     "best."},
    {"compare", compare,
     "Poses that exclude one another are compared on the pixels where they disagree."},
    {"select", select,
     "Distinct placements of sufficient score. Interpretations of the scene choose from these."},
};

consteval std::size_t place_of(std::string_view name) {
  std::size_t i = 0;
  while (kStages[i].name != name) ++i;
  return i;
}
constexpr std::size_t kRoundStages = place_of("score") + 1;  // those that every round runs
constexpr std::size_t kFirstScoring = place_of("refine");

// Of the time left, what a stage may take where others follow. The plan fits the work in the time
// before it runs: a stage that is cut here, because its frame is harder, leaves as much to the
// rest.
constexpr double kMostOfTimeLeft = 0.5;

// Runs a stage and records its time and what it rejects.
Candidates timed(const Stage& stage, Search& search, Candidates candidates, ObjectTrace* trace) {
  if (!trace) return stage.run(search, std::move(candidates));
  search.tracing = &trace->stage(stage.name, stage.text);
  const Stopwatch watch;
  candidates = stage.run(search, std::move(candidates));
  search.tracing->milliseconds += watch.milliseconds();
  return candidates;
}

// Rejects what loses against candidates of all models, except protected ones.
void reject_losers(const Stage& stage, std::span<const Search> searches,
                   std::vector<Candidates>& found) {
  const DetectPlan& plan = searches.front().plan;
  const int most =
      stage.most_in_library ? stage.most_in_library(plan) : std::numeric_limits<int>::max();
  const double limit = stage.behind ? plan.limits[*stage.behind] : kNoLimit;
  std::vector<Claim> claims;
  for (const Candidates& of_model : found) {
    std::ranges::transform(of_model, std::back_inserter(claims), claim_of);
  }
  const Contest contest = contest_of(std::move(claims), most);
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::erase_if(found[i], [&](Candidate& candidate) {
      if (candidate.is_protected) return false;
      const bool low = candidate.score <= contest.threshold;
      bool behind = false;
      if (!low && stage.behind) {
        const double lead = behind_best(claim_of(candidate), contest, limit);
        candidate.lowest.note(*stage.behind, lead);
        behind = lead < limit;
      }
      if (low) searches[i].reject("better ones of other models are enough", candidate.pose());
      if (behind) searches[i].reject("a better one is in its place", candidate.pose());
      return low || behind;
    });
  }
}

}  // namespace

std::span<const Stage> detection_stages() { return kStages; }
std::span<const Stage> round_stages() { return detection_stages().first(kRoundStages); }
std::span<const Stage> scoring_stages() { return round_stages().subspan(kFirstScoring); }
std::span<const Stage> final_stages() { return detection_stages().subspan(kRoundStages); }

void run_stages(std::span<const Stage> stages, std::span<Search> searches, int num_threads,
                std::vector<Candidates>& found, std::vector<ObjectTrace>* traces) {
  if (searches.empty()) return;
  if (traces) traces->resize(searches.size());
  const Deadline deadline = searches.front().deadline;
  const int threads = resolve_num_threads(num_threads);
  std::vector<std::size_t> order(searches.size());
  std::iota(order.begin(), order.end(), 0);
  for (const Stage& stage : stages) {
    const Deadline end = &stage == &stages.back() ? deadline : deadline.part(kMostOfTimeLeft);
    // A model's share grows with its candidates.
    const auto work = [&](std::size_t i) { return 1 + static_cast<int>(found[i].size()); };
    std::atomic<int> waiting{0};
    for (std::size_t i = 0; i < searches.size(); ++i) waiting += work(i);
    // The most work first, so that no thread ends long before the last.
    std::ranges::stable_sort(order, std::greater(), work);
    parallel_for(order.size(), num_threads, [&](std::size_t k) {
      const std::size_t i = order[k];
      const int own = work(i);
      const double share = static_cast<double>(threads * own) / waiting.fetch_sub(own);
      searches[i].deadline = end.part(std::min(1.0, share));
      found[i] = timed(stage, searches[i], std::move(found[i]), traces ? &(*traces)[i] : nullptr);
    });
    if (stage.most_in_library || stage.behind) {
      reject_losers(stage, searches, found);
    }
    if (!traces) continue;
    for (std::size_t i = 0; i < searches.size(); ++i) {
      for (const Candidate& c : found[i]) searches[i].tracing->poses.push_back(to_fast(c.pose()));
    }
  }
  for (Search& search : searches) search.deadline = deadline;
}

TraceStage& ObjectTrace::stage(std::string_view name, std::string_view text) {
  const auto found = std::ranges::find(stages, name, &TraceStage::name);
  if (found != stages.end()) return *found;
  stages.push_back({name, text, {}, 0, {}});
  return stages.back();
}

void TraceStage::reject(std::string_view reason, const FastPose& pose) {
  auto found = std::ranges::find(rejected, reason, &Rejected::reason);
  if (found == rejected.end()) found = rejected.insert(found, {reason, {}});
  found->poses.push_back(pose);
}

}  // namespace bpa::detect
