// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/output.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "client/cli/convert.hpp"
#include "core/base/failure.hpp"

namespace bpa::cli {
namespace {

std::string name_of(const Detection& d) { return d.model + "_" + std::to_string(d.instance); }

/// Prints one standard deviation of the position and of the rotation, over all directions.
void print_spread(const Detection& d) {
  const auto deviation = [&d](std::size_t first) {
    double sum = 0;
    for (std::size_t i = first; i < first + 3; ++i) sum += d.covariance[7 * i];
    return std::sqrt(std::max(0.0, sum));
  };
  std::printf("  +-%.1f mm +-%.1f deg", 1000 * deviation(0), deviation(3) * 57.29577951308232);
}

void print_detection(const Detection& d) {
  const auto& p = d.camera_from_object.position;
  const auto& q = d.camera_from_object.orientation;
  std::printf("    %-24s %5.1f %%  at (%+.3f %+.3f %+.3f) m  q (%+.3f %+.3f %+.3f %+.3f)",
              name_of(d).c_str(), 100 * d.presence, p[0], p[1], p[2], q[0], q[1], q[2], q[3]);
  print_spread(d);
  std::printf("  seen %.0f %%", 100 * d.visible_fraction);
  if (!d.alternatives.empty()) {
    std::printf("  this pose %.0f %%, or %zu others", 100 * d.probability, d.alternatives.size());
  }
  std::printf("\n");
}

std::map<std::string, int> models_of(const RankedInterpretation& interpretation) {
  std::map<std::string, int> models;
  for (const Detection& d : interpretation.detections) ++models[d.model];
  return models;
}

/// What an interpretation has more and less than the best one.
std::string difference(const RankedInterpretation& best, const RankedInterpretation& other) {
  std::map<std::string, int> change = models_of(other);
  for (const auto& [model, count] : models_of(best)) change[model] -= count;
  std::string text;
  for (const auto& [model, count] : change) {
    for (int i = 0; i < std::abs(count); ++i) {
      text += count > 0 ? " +" : " -";
      text += model;
    }
  }
  return text.empty() ? " the same objects, placed differently" : text;
}

}  // namespace

void print_table(const DetectionSet& set, double frames_per_second) {
  std::printf("\x1b[H\x1b[J");  // home, and clear what follows
  std::printf("frame %lld.%03lld  %s  %.1f a second  search %.0f ms\n",
              static_cast<long long>(set.stamp_ns / 1'000'000'000),
              static_cast<long long>(set.stamp_ns / 1'000'000 % 1000), set.frame_id.c_str(),
              frames_per_second, set.total_ms);
  if (set.status.ok()) {
    std::printf("%-24s %6s  %7s %7s %7s  %5s\n", "object", "sure", "x m", "y m", "z m", "seen");
  } else {
    std::printf("not searched: %s\n", set.status.message.c_str());
  }
  for (const Detection& d : set.best()) {
    const auto& p = d.camera_from_object.position;
    std::printf("%-24s %5.1f %%  %+7.3f %+7.3f %+7.3f  %3.0f %%", name_of(d).c_str(),
                100 * d.presence, p[0], p[1], p[2], 100 * d.visible_fraction);
    print_spread(d);
    std::printf("\n");
  }
  std::fflush(stdout);
}

void print_detections(const DetectionSet& set, int max_interpretations) {
  std::printf("frame %s: ", set.frame_id.c_str());
  if (!set.status.ok()) {
    std::printf("not searched (%s): %s\n", to_string(set.status.code), set.status.message.c_str());
  } else {
    std::printf("%zu interpretations of %d models in %.0f ms%s", set.interpretations.size(),
                set.models_searched, set.total_ms, set.budget_exhausted ? " (time was up)" : "");
    if (set.fused_frames > 1) std::printf(", %d frames combined", set.fused_frames);
    std::printf("\n");
    if (!set.status.message.empty()) std::printf("  %s\n", set.status.message.c_str());
  }
  int printed = 0;
  for (const RankedInterpretation& interpretation : set.interpretations) {
    if (printed++ == max_interpretations) break;
    std::printf("  #%d  %.1f %%", interpretation.rank, 100 * interpretation.probability);
    if (printed > 1) {
      std::printf(" %s\n", difference(set.interpretations.front(), interpretation).c_str());
      continue;
    }
    std::printf("  %zu objects\n", interpretation.detections.size());
    for (const Detection& d : interpretation.detections) print_detection(d);
  }
  std::fflush(stdout);
}

void write_results(const std::string& path, const std::vector<DetectionSet>& sets) {
  if (path.empty()) return;
  std::vector<io::FrameResult> frames;
  for (const DetectionSet& set : sets) frames.push_back(to_frame_result(set));
  or_throw(io::write_results_json(path, frames));
}

}  // namespace bpa::cli
