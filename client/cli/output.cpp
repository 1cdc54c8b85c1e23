// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/output.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>

#include <nlohmann/json.hpp>

namespace bpa::cli {
namespace {

using Json = nlohmann::json;

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

Json pose_json(const ObjectPose& pose) {
  const auto& q = pose.orientation;
  return {{"rotation_wxyz", {q[3], q[0], q[1], q[2]}}, {"translation_m", pose.position}};
}

Json detection_json(const Detection& d) {
  Json components = Json::object();
  for (const ScorePart& part : d.score_parts) components[part.name] = part.value;
  Json alternatives = Json::array();
  for (const AlternativePose& other : d.alternatives) {
    alternatives.push_back(
        {{"pose", pose_json(other.camera_from_object)}, {"weight", other.weight}});
  }
  Json axes = Json::array();  // row-major 4 x 3, an axis a column
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      axes.push_back(d.orientation_spread.axes[axis][row]);
    }
  }
  return {{"obj_id", d.model_number},
          {"model", d.model},
          {"pose", pose_json(d.camera_from_object)},
          {"covariance", d.covariance},
          {"bingham", {{"axes", axes}, {"concentrations", d.orientation_spread.concentrations}}},
          {"score", d.score},
          {"probability", d.probability},
          {"visible_fraction", d.visible_fraction},
          {"components", components},
          {"alternatives", alternatives}};
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

std::pair<int, int> scene_and_image(const std::string& frame_id) {
  int scene = 0, image = 0, length = 0;
  const int found = std::sscanf(frame_id.c_str(), "%d/%d%n", &scene, &image, &length);
  if (found != 2 || static_cast<std::size_t>(length) != frame_id.size()) return {0, 0};
  return {scene, image};
}

Json to_json(const DetectionSet& set) {
  Json interpretations = Json::array();
  for (const RankedInterpretation& interpretation : set.interpretations) {
    Json placements = Json::array();
    for (const Detection& d : interpretation.detections) placements.push_back(detection_json(d));
    interpretations.push_back({{"rank", interpretation.rank},
                               {"score", interpretation.score},
                               {"probability", interpretation.probability},
                               {"placements", placements}});
  }
  Json timings = Json::array();
  for (const StageTime& time : set.stage_times) {
    timings.push_back({{"stage", time.stage}, {"milliseconds", time.milliseconds}});
  }
  const auto [scene, image] = scene_and_image(set.frame_id);
  return {{"scene_id", scene},
          {"im_id", image},
          {"frame_id", set.frame_id},
          {"stamp_ns", set.stamp_ns},
          {"status", to_string(set.status.code)},
          {"message", set.status.message},
          {"seconds", 0.001 * set.total_ms},
          {"queue_position", set.queue_position},
          {"budget_exhausted", set.budget_exhausted},
          {"fused_frames", set.fused_frames},
          {"timings", timings},
          {"interpretations", interpretations}};
}

Status write_results(const std::string& path, const std::vector<DetectionSet>& sets) {
  Json frames = Json::array();
  for (const DetectionSet& set : sets) frames.push_back(to_json(set));
  std::ofstream file(path);
  file << Json{{"format", "bpa results"}, {"version", 1}, {"frames", frames}}.dump(1) << '\n';
  file.close();
  if (file) return {};
  return {StatusCode::unavailable, path + ": cannot be written"};
}

}  // namespace bpa::cli
