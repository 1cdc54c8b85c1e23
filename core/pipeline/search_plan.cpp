// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/search_plan.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/concat.hpp"
#include "core/io/options_yaml.hpp"

namespace bpa {
namespace {

// What a small budget leaves of the preparation: the first that takes at most this part of it. In
// 100 ms two seeds find 134/288 objects of YCB-Video and of seeds 100 and 777; with 1/3, 118/288.
// The sizes were chosen by hand on real and simulated frames of 640 x 480.
constexpr double kPreparationPart = 0.5;
struct Shortened {
  int max_width;  // pixels
  double share;   // of the whole preparation's time; measured
};
constexpr int kAnyWidth = 1 << 20;
constexpr Shortened kShortened[] = {{kAnyWidth, 0.75}, {240, 0.4}, {160, 0.3}};
constexpr int kFewKeypoints = 200;          // with any of them
constexpr double kRestOfPreparation = 5;    // times the surface; measured
constexpr double kTimeOfPreparation = 0.7;  // of what is left after the surface, at most; by hand

void shorten_preparation(const SearchFacts& facts, SearchPlan& plan, detect::PlanReasons& reasons) {
  const double fits = kPreparationPart * facts.budget_ms / facts.costs.preparation_ms;
  if (fits >= 1) return;
  const auto* shortened =
      std::ranges::find_if(kShortened, [&](const Shortened& one) { return one.share <= fits; });
  if (shortened == std::end(kShortened)) --shortened;
  plan.surface.max_width = std::min(plan.surface.max_width, shortened->max_width);
  plan.features.max_keypoints = std::min(plan.features.max_keypoints, kFewKeypoints);
  leave_out_details(plan.features);
  plan.prepared_share = shortened->share;
  const std::string why =
      concat("a whole preparation takes ", std::lround(facts.costs.preparation_ms),
             " ms, over half of a budget of ", facts.budget_ms, " ms");
  for (const char* name : {"surface.max_width", "features.max_keypoints", "features.use_outline",
                           "features.use_flat_regions"}) {
    reasons[name] = why;
  }
}

// Every setting as planned, beside the user's and the default.
std::vector<PlanEntry> settings_of(const SearchPlan& plan, DetectorOptions given,
                                   const detect::PlanReasons& reasons) {
  DetectorOptions planned = plan.settings(), defaults;
  const auto used = options_of(planned), asked = options_of(given), usual = options_of(defaults);
  std::vector<PlanEntry> out;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i].is_group()) continue;
    const std::string value = io::value_text(used[i]);
    const auto reason = reasons.find(used[i].path);
    const bool planned_here = value != io::value_text(asked[i]) && reason != reasons.end();
    const std::string own = value == io::value_text(usual[i]) ? "default" : "setting";
    out.push_back({used[i].path, value, planned_here ? reason->second : own});
  }
  return out;
}

std::vector<PlanEntry> entries_of(const SearchPlan& plan, const DetectorOptions& options,
                                  const score::ScoreLayers& layers, int image_width,
                                  const detect::PlanReasons& reasons) {
  std::vector<PlanEntry> out = settings_of(plan, options, reasons);
  const auto add = [&](const std::string& name, const auto& value, const std::string& reason) {
    const auto found = reasons.find(name);
    out.push_back({name, concat(value), found == reasons.end() ? reason : found->second});
  };
  add("limits.provenance", layers.limits.provenance, "score layers");
  if (image_width > 0) {
    const int most = plan.surface.max_width;
    add("surface.reduction", map_reduction(image_width, most),
        concat(image_width, " pixels / surface.max_width, rounded up"));
  }
  const score::SearchYield& yield = plan.yield;
  const std::string& measured = layers.yield.provenance;
  add("yield.shape", yield.shape, measured);
  add("yield.tries", yield.tries, measured);
  add("yield.visible", yield.visible, measured);
  add("yield.objects", yield.objects, measured);
  add("yield.scenes", yield.scenes, measured);
  const std::string kept = concat("keeps ", plan.detect.score.keep_right, " of the right ones");
  for (std::size_t i = 0; i < score::kLimits; ++i) {
    add(concat("limits.", score::kLimitNames[i]), plan.detect.limits.stages[i], kept);
  }
  if (!plan.limited) return out;
  const std::string why = "share of the time left";
  add("time.search", plan.time.search, why);
  add("time.rounds", plan.time.rounds, why);
  add("time.first_round", plan.time.first_round, why);
  add("time.next_round", plan.time.next_round, why);
  add("time.smallest_round", plan.time.smallest_round, "share of a whole round");
  return out;
}

}  // namespace

Result<SearchPlan> plan_search(const DetectorOptions& options, const score::ScoreLayers& layers,
                               const SearchFacts& facts) {
  const double keep_right = options.detect.score.keep_right;
  if (const auto limits = layers.limits.at(keep_right, facts.colored); !limits.ok()) {
    return limits.status();
  }
  if (facts.models < 1 || !(facts.budget_ms >= 0) || !(facts.costs.preparation_ms >= 0)) {
    return invalid_argument("a search is for ", facts.models, " models in ", facts.budget_ms,
                            " ms with preparations of ", facts.costs.preparation_ms,
                            " ms; it must be for 1 or more, in no negative times");
  }
  detect::PlanReasons reasons;
  SearchPlan plan{
      .surface = options.surface,
      .planes = options.planes,
      .features = options.features,
      .rounds = options.rounds,
      .detect = detect::DetectPlan(options.detect, layers, {facts.models, facts.colored}, &reasons),
      .scene = options.scene,
      .views = options.views,
      .yield = facts.colored ? layers.yield.with_color : layers.yield.without_color,
      .limited = facts.budget_ms > 0};
  plan.surface.num_threads = plan.features.num_threads = facts.threads;
  plan.planes.seed = plan.features.seed = plan.scene.seed = facts.seed;
  if (plan.features.use_outline && !(plan.features.use_color && facts.outlines)) {
    plan.features.use_outline = false;
    reasons["features.use_outline"] =
        facts.outlines ? "features.use_color is false" : facts.colorless;
  }
  if (plan.features.use_color && facts.colorless) {  // outlines are seen in grey, too
    plan.features.use_color = false;
    reasons["features.use_color"] = facts.colorless;
  }
  if (plan.limited) shorten_preparation(facts, plan, reasons);
  plan.entries = entries_of(plan, options, layers, facts.image_width, reasons);
  return plan;
}

SceneFeatureOptions round_sample(const SearchPlan& plan, double share) {
  SceneFeatureOptions out = plan.features;
  if (share >= 1) return out;
  for (int* size : {&out.max_references, &out.round_keypoints})
    *size = detect::part_of(*size, share);
  return out;
}

bool details_fit(double surface_ms, double milliseconds_left) {
  return kRestOfPreparation * surface_ms <= kTimeOfPreparation * milliseconds_left;
}

void leave_out_details(SceneFeatureOptions& options) {
  options.use_outline = options.use_flat_regions = false;
}

SearchPace::SearchPace(const Costs& costs, double preparation_ms, int models)
    : preparation_ms_(preparation_ms),
      unit_ms_(preparation_ms * models),
      round_ms_(costs.round_share * unit_ms_),
      final_per_round_(costs.final_share / costs.round_share) {}

double SearchPace::share_of_round(double milliseconds, double smallest) const {
  const double share = milliseconds / round_ms_;
  return share < smallest ? 0 : std::min(share, 1.0);
}

double SearchPace::share_of_final(double milliseconds) const {
  return std::min(1.0, milliseconds / (round_ms_ * final_per_round_));
}

void SearchPace::took(double share, double milliseconds) {
  round_ms_ = milliseconds / share;
  rounds_ += share;
  rounds_ms_ += milliseconds;
}

Costs SearchPace::measured(double final_share, double final_ms) const {
  Costs out{.preparation_ms = preparation_ms_, .round_share = 0, .final_share = 0};
  if (rounds_ > 0) out.round_share = rounds_ms_ / rounds_ / unit_ms_;
  if (final_share > 0) out.final_share = final_ms / final_share / unit_ms_;
  return out;
}

}  // namespace bpa
