// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/yield.hpp"

#include <algorithm>
#include <map>

#include "core/eval/pose_errors.hpp"
#include "core/model/model_index.hpp"

namespace bpa::cli {
namespace {

constexpr int kMostRounds = 16;
constexpr double kFound = 0.5;  // the probability of a right placement that counts as found

using Instance = std::tuple<std::string, std::size_t, std::size_t>;  // folder, frame, number

const detect::Candidate* found_at(const io::BopInstance& instance,
                                  const detect::Candidates& candidates) {
  const auto right = std::ranges::find_if(candidates, [&](const detect::Candidate& one) {
    return one.probability >= kFound &&
           eval::is_right_about_any(one.pose(), *one.model, {instance});
  });
  return right == candidates.end() ? nullptr : &*right;
}

// A candidate's points of SceneFeatures::coarse, and of these the reference points of some rounds.
struct VisiblePoints {
  int all = 0, first = 0, before = 0;
};

VisiblePoints visible_points(const SceneFeatures& scene, const detect::Candidate& candidate,
                             int first, int before) {
  VisiblePoints out;
  for (int i = 0; i < std::ssize(scene.references); ++i) {
    const int pixel = scene.image.pixel_of(scene.coarse.points[scene.references[i]]);
    if (!std::ranges::binary_search(candidate.explained, static_cast<std::uint32_t>(pixel))) {
      continue;
    }
    ++out.all;
    out.first += i < first;
    out.before += i < before;
  }
  return out;
}

}  // namespace

score::SearchYield search_yield(const std::shared_ptr<const ModelLibrary>& library,
                                DetectorOptions options, const score::ScoreLayers& layers,
                                const std::vector<DatasetOptions>& datasets,
                                const CommonOptions& common, int models_per_frame,
                                const score::SearchYield& start) {
  options.rounds.max_missed = 0;
  options.rounds.min_certain = 1;
  const double cell = options.features.coarse_spacing_m * options.features.coarse_spacing_m;
  std::map<Instance, score::Discovery> discoveries;
  std::map<std::pair<std::string, std::size_t>, int> objects;
  for (int rounds = 1; rounds <= kMostRounds; rounds *= 2) {
    options.rounds.max_rounds = rounds;
    const int first = rounds * options.features.max_references;
    const Detector detector(library, options, layers);
    for (const DatasetOptions& dataset : datasets) {
      const auto use = [&](const TrueFrame& frame, const auto&, const FrameTrace& trace) {
        int& in_frame = objects[{dataset.folder, frame.index}];
        for (std::size_t i = 0; i < frame.truth.size(); ++i) {
          const Instance instance(dataset.folder, frame.index, i);
          if (discoveries.contains(instance)) continue;
          const detect::Candidate* found = found_at(frame.truth[i], trace.candidates);
          if (found == nullptr) continue;
          const auto points =
              visible_points(trace.scene, *found, first, rounds == 1 ? 0 : first / 2);
          if (points.all == 0) continue;
          ++in_frame;
          // Keypoints, and pairs of others' reference points, find some without a try of their own.
          discoveries[instance] = {.after = static_cast<double>(points.before),
                                   .at_most = std::max<double>(points.first, points.before + 1),
                                   .visible = points.all * cell / surface_area(*found->model)};
        }
      };
      search_frames(detector, dataset, common, use, models_per_frame);
    }
  }
  std::vector<score::Discovery> all;
  for (const auto& [instance, discovery] : discoveries) all.push_back(discovery);
  std::vector<int> counts;
  for (const auto& [frame, count] : objects) counts.push_back(count);
  return score::measure_yield(all, counts, start);
}

}  // namespace bpa::cli
