// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/private/json_fields.hpp"
#include "core/io/results.hpp"

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

static void fields(auto& visit, io::Is<PoseAlternative> auto& alternative) {
  visit("pose", alternative.camera_from_object);
  visit("weight", alternative.weight);
}

static void fields(auto& visit, io::Is<OrientationUncertainty> auto& orientation) {
  visit("axes", orientation.axes);
  visit("concentrations", orientation.concentrations);
}

static void fields(auto& visit, io::Is<Placement> auto& placement) {
  visit("obj_id", placement.model_number);
  visit("model", placement.model, kOptional);
  visit("pose", placement.camera_from_object);
  visit("covariance", placement.covariance, kOptional);
  visit("bingham", placement.orientation, kOptional);
  visit("score", placement.score, kOptional);
  visit("probability", placement.probability);
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

namespace io {

constexpr const char* kFormat = "bpa results";
constexpr int kVersion = 1;

static void fields(auto& visit, Is<FrameResult> auto& frame) {
  visit("scene_id", frame.scene_id);
  visit("im_id", frame.im_id);
  visit("seconds", frame.seconds);
  visit("budget_exhausted", frame.budget_exhausted, kOptional);
  visit("fused_frames", frame.fused_frames, kOptional);
  visit("timings", frame.timings, kOptional);
  visit("interpretations", frame.interpretations);
  if constexpr (!std::is_const_v<std::remove_reference_t<decltype(frame)>>) {
    if (visit.has("status")) frame.server.emplace();
  }
  if (!frame.server) return;
  visit("frame_id", frame.frame_id, kOptional);
  visit("stamp_ns", frame.stamp_ns, kOptional);
  visit("status", frame.server->status.code);
  visit("message", frame.server->status.message, kOptional);
  visit("queue_position", frame.server->queue_position, kOptional);
}

std::string result_json_line(const FrameResult& result) {
  return Json(result).dump(-1, ' ', false, Json::error_handler_t::replace);
}

Status write_results_json(const std::string& path, const std::vector<FrameResult>& results) {
  return with_json(path, [&]() {
    const Json json = {{"format", kFormat}, {"version", kVersion}, {"frames", results}};
    return write_file(path, json.dump(1) + "\n");
  });
}

Result<std::vector<FrameResult>> read_results_json(const std::string& path) {
  const Result<Json> json = read_json(path);
  if (!json.ok()) return json.status();
  return with_json(path, [&]() -> Result<std::vector<FrameResult>> {
    if (json->value("format", "") != kFormat || json->at("version").get<int>() != kVersion) {
      return Status(StatusCode::corrupt,
                    path + " is not a result file of version " + std::to_string(kVersion));
    }
    return json->at("frames").get<std::vector<FrameResult>>();
  });
}

}  // namespace io
}  // namespace bpa
