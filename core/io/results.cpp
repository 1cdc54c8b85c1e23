// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/results.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <sstream>
#include <string_view>

#include "core/io/private/result_json.hpp"

/// The components as an object: name -> value.
template <>
struct nlohmann::adl_serializer<std::vector<bpa::ScoreComponent>> {
  static void to_json(json& out, const std::vector<bpa::ScoreComponent>& components) {
    out = json::object();
    for (const bpa::ScoreComponent& component : components) out[component.name] = component.value;
  }
  static void from_json(const json& in, std::vector<bpa::ScoreComponent>& components) {
    for (const auto& [name, value] : in.items()) components.push_back({name, value.get<double>()});
  }
};

/// The plan as an object: name -> {value, reason}.
template <>
struct nlohmann::adl_serializer<std::vector<bpa::PlanEntry>> {
  static void to_json(json& out, const std::vector<bpa::PlanEntry>& plan) {
    out = json::object();
    for (const auto& [name, value, reason] : plan) {
      const json typed = json::parse(value, nullptr, false);
      out[name] = {{"value", typed.is_discarded() ? json(value) : typed}, {"reason", reason}};
    }
  }
  static void from_json(const json& in, std::vector<bpa::PlanEntry>& plan) {
    for (const auto& [name, entry] : in.items()) {
      plan.push_back({name, entry.at("value").dump(), entry.at("reason").get<std::string>()});
    }
  }
};

/// A code by its name; a name that this version does not know is `internal`.
template <>
struct nlohmann::adl_serializer<bpa::StatusCode> {
  static void to_json(json& out, bpa::StatusCode code) { out = bpa::to_string(code); }
  static void from_json(const json& in, bpa::StatusCode& code) {
    const auto last = static_cast<int>(bpa::StatusCode::internal);
    for (int k = 0; k <= last; ++k) {
      code = static_cast<bpa::StatusCode>(k);
      if (in == bpa::to_string(code)) return;
    }
  }
};

namespace bpa {

using io::kOptional;

static void fields(auto& visit, io::Is<Placement> auto& placement) {
  visit("obj_id", placement.model_number);
  visit("model", placement.model, kOptional);
  visit("pose", placement.frame_from_object);
  visit("covariance", placement.covariance, kOptional);
  visit("bingham", placement.orientation, kOptional);
  visit("score", placement.score, kOptional);
  visit("probability", placement.probability);
  visit("presence", placement.presence, kOptional);
  visit("visible_fraction", placement.visible_fraction, kOptional);
  visit("components", placement.components, kOptional);
  visit("alternatives", placement.alternatives, kOptional);
}

static void fields(auto& visit, io::Is<Interpretation> auto& interpretation) {
  visit("rank", interpretation.rank);
  visit("score", interpretation.score, kOptional);
  visit("probability", interpretation.probability, kOptional);
  visit("placements", interpretation.placements);
}

static void fields(auto& visit, io::Is<StageTiming> auto& timing) {
  visit("stage", timing.stage);
  visit("milliseconds", timing.milliseconds);
}

static void fields(auto& visit, io::Is<MissedModel> auto& missed) {
  visit("model", missed.model);
  visit("expected", missed.expected);
}

static void fields(auto& visit, io::Is<SearchEffort> auto& effort) {
  for (const auto& [name, count] : kEffortCounts) visit(name, effort.*count, kOptional);
}

namespace io {

constexpr FramesFormat kResultFormat{"bpa results", "a result file", 1};

static void fields(auto& visit, Is<FrameResult> auto& frame) {
  visit("scene_id", frame.scene_id);
  visit("im_id", frame.im_id);
  visit("seconds", frame.seconds);
  visit("budget_exhausted", frame.budget_exhausted, kOptional);
  visit("fused_frames", frame.fused_frames, kOptional);
  visit("missed", frame.missed, kOptional);
  visit("timings", frame.timings, kOptional);
  visit("interpretations", frame.interpretations);
  constexpr bool kReads = !std::is_const_v<std::remove_reference_t<decltype(frame)>>;
  if constexpr (kReads) {
    if (visit.has("status")) frame.server.emplace();
  }
  if (kReads || frame.server || frame.stamp_ns != 0) {
    visit("frame_id", frame.frame_id, kOptional);
    visit("stamp_ns", frame.stamp_ns, kOptional);
  }
  if (!frame.server) {
    visit("sensor", frame.sensor, kOptional);
    visit("effort", frame.effort, kOptional);
    visit("plan", frame.plan, kOptional);
    return;
  }
  visit("status", frame.server->status.code);
  visit("message", frame.server->status.message, kOptional);
  visit("queue_position", frame.server->queue_position, kOptional);
}

std::string results_json(const std::vector<FrameResult>& results) {
  return frames_json(kResultFormat, results);
}

std::string result_json_line(const FrameResult& result) { return json_line(result); }

Status write_results_json(const std::string& path, const std::vector<FrameResult>& results) {
  return write_frames_json(path, kResultFormat, results);
}

Result<std::vector<FrameResult>> read_results_json(const std::string& path) {
  return read_frames_json<FrameResult>(path, kResultFormat);
}

namespace {

constexpr const char* kCsvHeader = "scene_id,im_id,obj_id,score,R,t,time";

void write_number(std::ostream& out, double value, char separator) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;  // shortest exact form
  out.write(text, end - text) << separator;
}

void write_row(std::ostream& out, const FrameResult& frame, const Placement& placement) {
  out << frame.scene_id << ',' << frame.im_id << ',' << placement.model_number << ',';
  write_number(out, placement.presence, ',');
  const Eigen::Matrix3d r = placement.frame_from_object.matrix();
  for (int i = 0; i < 9; ++i) write_number(out, r(i / 3, i % 3), i < 8 ? ' ' : ',');
  for (int i = 0; i < 3; ++i) {
    write_number(out, kMillimetres * placement.frame_from_object.translation[i], i < 2 ? ' ' : ',');
  }
  write_number(out, frame.seconds, '\n');
}

/// Splits into exactly as many numbers as there is room for; false otherwise.
bool parse_numbers(std::string_view text, std::span<double> values) {
  const char* at = text.data();
  const char* const end = at + text.size();
  for (double& value : values) {
    while (at != end && *at == ' ') ++at;
    const auto result = std::from_chars(at, end, value);
    if (result.ec != std::errc() || !std::isfinite(value)) return false;
    at = result.ptr;
  }
  while (at != end && (*at == ' ' || *at == '\r')) ++at;
  return at == end;
}

bool whole_int(double value) {
  return value == std::trunc(value) && std::abs(value) <= std::numeric_limits<int>::max();
}

struct CsvRow {
  double scene[1], image[1], object[1], score[1], rotation[9], translation[3], time[1];
};

/// Empty when the line is right; else the name of the wrong column.
std::string parse_row(const std::string& line, CsvRow& row) {
  const std::pair<const char*, std::span<double>> columns[] = {{"scene_id", row.scene},
                                                               {"im_id", row.image},
                                                               {"obj_id", row.object},
                                                               {"score", row.score},
                                                               {"R (9 numbers)", row.rotation},
                                                               {"t (3 numbers)", row.translation},
                                                               {"time", row.time}};
  if (std::count(line.begin(), line.end(), ',') != 6) return "count (7 columns are needed)";
  std::string_view rest = line;
  for (const auto& [name, values] : columns) {
    const std::string_view cell = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(cell.size() + 1, rest.size()));
    if (!parse_numbers(cell, values)) return name;
  }
  const bool whole = whole_int(row.scene[0]) && whole_int(row.image[0]) && whole_int(row.object[0]);
  return whole ? "" : "scene_id, im_id or obj_id (whole numbers)";
}

Placement placement_of(const CsvRow& row) {
  Placement placement;
  placement.model_number = static_cast<int>(row.object[0]);
  placement.score = placement.probability = placement.presence = row.score[0];
  using Rotation = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  placement.frame_from_object =
      Pose::from_matrix(Eigen::Map<const Rotation>(row.rotation),
                        Eigen::Map<const Eigen::Vector3d>(row.translation) / kMillimetres);
  return placement;
}

}  // namespace

Status write_results_csv(const std::string& path, const std::vector<FrameResult>& results) {
  std::ostringstream out;
  out << kCsvHeader << '\n';
  for (const FrameResult& frame : results) {
    if (frame.interpretations.empty()) continue;
    for (const Placement& placement : frame.interpretations.front().placements) {
      write_row(out, frame, placement);
    }
  }
  return write_file(path, out.str());
}

Result<std::vector<FrameResult>> read_results_csv(const std::string& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  std::map<std::pair<int, int>, FrameResult> frames;
  std::istringstream in(*bytes);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line == "\r" || (number == 1 && line.rfind("scene_id", 0) == 0)) continue;
    CsvRow row;
    if (const std::string wrong = parse_row(line, row); !wrong.empty()) {
      return corrupt(path, " line ", number, ": wrong column ", wrong);
    }
    const std::pair key(static_cast<int>(row.scene[0]), static_cast<int>(row.image[0]));
    FrameResult& frame = frames[key];
    frame.scene_id = key.first;
    frame.im_id = key.second;
    frame.seconds = row.time[0];
    frame.interpretations.resize(1);
    frame.interpretations.front().probability = 1;
    frame.interpretations.front().placements.push_back(placement_of(row));
  }
  std::vector<FrameResult> results;
  for (auto& [key, frame] : frames) results.push_back(std::move(frame));
  return results;
}

}  // namespace io
}  // namespace bpa
