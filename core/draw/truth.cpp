// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/draw/truth.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>

#include "core/base/concat.hpp"
#include "core/draw/annotate.hpp"
#include "core/draw/sheet.hpp"
#include "core/eval/pose_errors.hpp"

namespace bpa::draw {
namespace {

constexpr Rgb kWrong = {255, 40, 40};
constexpr double kMinVisible = 0.1;  // as EvaluationOptions::min_visible_fraction

using Models = std::map<int, std::shared_ptr<const ObjectModel>>;

/// The index of the truth that each placement is right about, or -1.
std::vector<int> match(const std::vector<io::BopInstance>& truth,
                       const std::vector<Placement>& placements, const Models& models) {
  std::vector<double> scores;
  std::vector<std::vector<double>> costs;
  for (const Placement& placement : placements) {
    scores.push_back(placement.probability);
    costs.emplace_back(truth.size(), eval::kNoMatch);
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const auto model = models.find(truth[t].obj_id);
      if (model == models.end() || truth[t].obj_id != placement.model_number) continue;
      costs.back()[t] = eval::right_cost(placement.camera_from_object, truth[t].camera_from_object,
                                         model->second->symmetry);
    }
  }
  return eval::match_greedily(scores, costs);
}

void mark_wrong(DrawnObject& object, const std::string& word) {
  object.label = word + " " + object.label;
  object.color = kWrong;
  object.emphasised = true;
}

}  // namespace

JudgedFrame truth_beside_result(const Frame& frame, const std::vector<io::BopInstance>& truth,
                                const Interpretation& result, const ModelLibrary& library,
                                const std::string& caption) {
  Models models;
  for (const auto& model : library.models()) models[model->number] = model;
  const std::vector<int> truth_of = match(truth, result.placements, models);
  JudgedFrame judged;
  std::vector<DrawnObject> left, right;
  for (std::size_t t = 0; t < truth.size(); ++t) {
    const auto model = models.find(truth[t].obj_id);
    const bool counts = truth[t].visible_fraction >= kMinVisible;
    const bool found = std::count(truth_of.begin(), truth_of.end(), static_cast<int>(t)) > 0;
    judged.found += counts && found;
    judged.missed += counts && !found;
    if (model == models.end()) continue;
    left.push_back({&model->second->surface, truth[t].camera_from_object, model->second->name,
                    object_color(truth[t].obj_id), false});
    if (counts && !found) mark_wrong(left.back(), "MISSED");
  }
  for (std::size_t e = 0; e < result.placements.size(); ++e) {
    const auto model = models.find(result.placements[e].model_number);
    if (model == models.end()) continue;
    right.push_back(placed(result.placements[e], *model->second));
    if (truth_of[e] >= 0) continue;
    mark_wrong(right.back(), "FALSE");
    ++judged.wrong;
  }
  const std::string summary = concat("result: ", judged.found, " of ", judged.found + judged.missed,
                                     " found, ", judged.wrong, " false");
  judged.picture = beside(with_words(objects(frame, left), caption + " truth"),
                          with_words(objects(frame, right), summary));
  return judged;
}

std::vector<std::size_t> worst_first(const std::vector<JudgedFrame>& frames) {
  std::vector<std::size_t> order(frames.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(),
                           [&frames](std::size_t i) { return frames[i].missed + frames[i].wrong; });
  return order;
}

}  // namespace bpa::draw
