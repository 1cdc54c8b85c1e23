// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/detect_plan.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/concat.hpp"

namespace bpa::detect {
namespace {

// Candidates of all models that go on, for kModels models; `without_color` times as many where
// colours tell nothing. Chosen by hand on simulated piles.
struct LibraryCount {
  const char* name;
  int& (*count)(DetectOptions&);
  int base, without_color;
};
constexpr LibraryCount kLibraryCounts[] = {
    {"check.max_in_library", [](DetectOptions& o) -> int& { return o.check.max_in_library; }, 800,
     3},
    {"cluster.max_in_library", [](DetectOptions& o) -> int& { return o.cluster.max_in_library; },
     180, 2},
    {"round_two.max_in_library",
     [](DetectOptions& o) -> int& { return o.round_two.max_in_library; }, 60, 2}};
// Twice as many for eight times the models. With 200 models, limits 1.5, 2 and 2.9 times as high
// find 400/612, 403/612 and 412/612 objects of seed 777 in 2.0, 2.1 and 2.4 times as long.
constexpr int kModels = 24;

// Poses voted for at each reference point, with and without colours. Chosen by hand on piles.
constexpr int kPeaks[] = {5, 2}, kRimPeaks[] = {2, 1};

void plan_counts(const DetectFacts& facts, DetectOptions& plan, PlanReasons& reasons) {
  const double more = std::cbrt(std::max(1.0, static_cast<double>(facts.models) / kModels));
  for (const LibraryCount& entry : kLibraryCounts) {
    int& count = entry.count(plan);
    if (count != 0) continue;
    const int base = facts.colored ? entry.base : entry.without_color * entry.base;
    count = static_cast<int>(std::lround(more * base));
    std::string& reason = reasons[entry.name];
    reason = concat(entry.base,
                    facts.colored ? "" : concat(" x ", entry.without_color, " without colours"));
    reason += more > 1 ? concat(" x cbrt(", facts.models, " models / ", kModels, ")")
                       : concat(" for up to ", kModels, " models");
  }
}

void plan_peaks(const DetectFacts& facts, SampleOptions& sample, PlanReasons& reasons) {
  const char* const why = facts.colored ? "votes agree in colour" : "without colours";
  if (sample.peaks_per_reference == 0) {
    sample.peaks_per_reference = kPeaks[facts.colored];
    reasons["sample.peaks_per_reference"] = why;
  }
  if (sample.rim_peaks_per_reference < 0) {
    sample.rim_peaks_per_reference = kRimPeaks[facts.colored];
    reasons["sample.rim_peaks_per_reference"] = why;
  }
}

}  // namespace

int part_of(int count, double share) {
  return std::min(count, std::max(1, static_cast<int>(std::lround(share * count))));
}

DetectPlan::DetectPlan(const DetectOptions& options, const score::ScoreLayers& layers,
                       const DetectFacts& facts, PlanReasons* reasons)
    : DetectOptions(options),
      limits(*layers.limits.at(score.keep_right, facts.colored)),
      limits_by_color{*layers.limits.at(score.keep_right, false),
                      *layers.limits.at(score.keep_right, true)} {
  PlanReasons unused;
  PlanReasons& why = reasons ? *reasons : unused;
  plan_counts(facts, *this, why);
  plan_peaks(facts, sample, why);
}

DetectPlan round_plan(const DetectPlan& whole, double share) {
  DetectPlan out = whole;
  if (share >= 1) return out;
  for (const LibraryCount& entry : kLibraryCounts) {
    int& count = entry.count(out);
    count = part_of(count, share);
  }
  return out;
}

DetectPlan final_plan(const DetectPlan& whole, double share) {
  DetectPlan out = whole;
  if (share >= 1) return out;
  for (int* size : {&out.climb.max_climbed, &out.turn.max_turned, &out.lay.max_laid}) {
    *size = part_of(*size, share);
  }
  return out;
}

}  // namespace bpa::detect
