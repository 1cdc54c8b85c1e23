// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/output.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "client/cli/convert.hpp"

namespace bpa::cli {
namespace {

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

/// One standard deviation of the position (mm) and of the rotation (degrees), over all directions.
std::string spread(const Detection& d) {
  const auto deviation = [&d](std::size_t first) {
    double sum = 0;
    for (std::size_t i = first; i < first + 3; ++i) sum += d.covariance[7 * i];
    return std::sqrt(std::max(0.0, sum));
  };
  return format("+-%.1f mm", 1000 * deviation(0)) +
         format(" +-%.1f deg", deviation(3) * 57.29577951308232);
}

void print_detection(std::ostream& out, const Detection& d) {
  char line[256];
  const auto& p = d.camera_from_object.position;
  const auto& q = d.camera_from_object.orientation;
  std::snprintf(line, sizeof line,
                "    %-24s %5.1f %%  at (%+.3f %+.3f %+.3f) m  q (%+.3f %+.3f %+.3f %+.3f)",
                (d.model + "_" + std::to_string(d.instance)).c_str(), 100 * d.probability, p[0],
                p[1], p[2], q[0], q[1], q[2], q[3]);
  out << line << "  " << spread(d) << "  seen " << format("%.0f %%", 100 * d.visible_fraction);
  if (!d.alternatives.empty()) out << "  or " << d.alternatives.size() << " other poses";
  out << '\n';
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

void print_table(std::ostream& out, const DetectionSet& set, double frames_per_second) {
  char line[200];
  std::snprintf(line, sizeof line, "frame %lld.%03lld  %s  %.1f a second  search %.0f ms",
                static_cast<long long>(set.stamp_ns / 1'000'000'000),
                static_cast<long long>(set.stamp_ns / 1'000'000 % 1000), set.frame_id.c_str(),
                frames_per_second, set.total_ms);
  out << line << '\n';
  if (!set.status.ok()) {
    out << "not searched: " << set.status.message << '\n';
    return;
  }
  std::snprintf(line, sizeof line, "%-24s %6s  %7s %7s %7s  %5s", "object", "sure", "x m", "y m",
                "z m", "seen");
  out << line << '\n';
  for (const Detection& d : set.best()) {
    const auto& p = d.camera_from_object.position;
    std::snprintf(line, sizeof line, "%-24s %5.1f %%  %+7.3f %+7.3f %+7.3f  %3.0f %%",
                  (d.model + "_" + std::to_string(d.instance)).c_str(), 100 * d.probability, p[0],
                  p[1], p[2], 100 * d.visible_fraction);
    out << line << "  " << spread(d) << '\n';
  }
}

void print_detections(std::ostream& out, const DetectionSet& set, int max_interpretations) {
  out << "frame " << set.frame_id << ": ";
  if (!set.status.ok()) {
    out << "not searched (" << to_string(set.status.code) << "): " << set.status.message << '\n';
    return;
  }
  out << set.interpretations.size() << " interpretations of " << set.models_searched
      << " models in " << format("%.0f", set.total_ms) << " ms"
      << (set.budget_exhausted ? " (time was up)" : "");
  if (set.fused_frames > 1) out << ", " << set.fused_frames << " frames combined";
  out << '\n';
  int printed = 0;
  for (const RankedInterpretation& interpretation : set.interpretations) {
    if (printed++ == max_interpretations) break;
    out << "  #" << interpretation.rank << format("  %.1f %%", 100 * interpretation.probability);
    if (printed > 1) {
      out << ' ' << difference(set.interpretations.front(), interpretation) << '\n';
      continue;
    }
    out << "  " << interpretation.detections.size() << " objects\n";
    for (const Detection& d : interpretation.detections) print_detection(out, d);
  }
}

Status write_results(const std::string& path, const std::vector<DetectionSet>& sets) {
  if (path.empty()) return {};
  std::vector<io::FrameResult> frames;
  for (const DetectionSet& set : sets) frames.push_back(to_frame_result(set));
  return io::write_results_json(path, frames);
}

}  // namespace bpa::cli
