// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <concepts>
#include <type_traits>

#include "core/io/private/json_file.hpp"
#include "core/io/results.hpp"

// Each struct's keys are listed once, in fields(), for the reader and the writer.

namespace bpa {
namespace {

using io::Json;

constexpr const char* kFormat = "bpa results";
constexpr int kVersion = 1;

enum Presence { optional, needed };

struct Writer {
  Json& json;

  void operator()(const char* key, const auto& value, Presence = optional) { json[key] = value; }
  void operator()(const char* key, const std::vector<ScoreComponent>& parts) {
    json[key] = Json::object();
    for (const ScoreComponent& part : parts) json[key][part.name] = part.value;
  }
  void operator()(const char* key, StatusCode code) { json[key] = to_string(code); }
};

/// A field whose key is missing keeps its value, unless it is needed.
struct Reader {
  const Json& json;

  void operator()(const char* key, auto& value, Presence presence = optional) {
    if (presence == needed || json.contains(key)) json.at(key).get_to(value);
  }
  void operator()(const char* key, std::vector<ScoreComponent>& parts) {
    const Json none = Json::object();
    const Json& values = json.contains(key) ? json.at(key) : none;
    for (const auto& [name, value] : values.items()) parts.push_back({name, value.get<double>()});
  }
  void operator()(const char* key, StatusCode& code) {
    const auto name = json.value(key, "ok");
    for (code = StatusCode::ok; code != StatusCode::internal && to_string(code) != name;) {
      code = static_cast<StatusCode>(static_cast<int>(code) + 1);
    }
  }
};

template <class T, class U>
concept Is = std::same_as<std::remove_const_t<T>, U>;

void fields(auto& visit, Is<PoseAlternative> auto& alternative) {
  visit("pose", alternative.camera_from_object, needed);
  visit("weight", alternative.weight, needed);
}

void fields(auto& visit, Is<OrientationUncertainty> auto& orientation) {
  visit("axes", orientation.axes, needed);
  visit("concentrations", orientation.concentrations, needed);
}

void fields(auto& visit, Is<Placement> auto& placement) {
  visit("obj_id", placement.model_number, needed);
  visit("model", placement.model);
  visit("pose", placement.camera_from_object, needed);
  visit("covariance", placement.covariance);
  visit("bingham", placement.orientation);
  visit("score", placement.score);
  visit("probability", placement.probability, needed);
  visit("visible_fraction", placement.visible_fraction);
  visit("components", placement.components);
  visit("alternatives", placement.alternatives);
}

void fields(auto& visit, Is<Interpretation> auto& interpretation) {
  visit("rank", interpretation.rank, needed);
  visit("score", interpretation.score);
  visit("probability", interpretation.probability);
  visit("placements", interpretation.placements, needed);
}

void fields(auto& visit, Is<StageTiming> auto& timing) {
  visit("stage", timing.stage, needed);
  visit("milliseconds", timing.milliseconds, needed);
}

void server_fields(auto& visit, Is<io::FrameResult> auto& frame) {
  visit("frame_id", frame.frame_id);
  visit("stamp_ns", frame.stamp_ns);
  visit("status", frame.server->status.code);
  visit("message", frame.server->status.message);
  visit("queue_position", frame.server->queue_position);
}

void fields(auto& visit, Is<io::FrameResult> auto& frame) {
  visit("scene_id", frame.scene_id, needed);
  visit("im_id", frame.im_id, needed);
  visit("seconds", frame.seconds, needed);
  visit("budget_exhausted", frame.budget_exhausted);
  visit("fused_frames", frame.fused_frames);
  visit("timings", frame.timings);
  visit("interpretations", frame.interpretations, needed);
  if (frame.server) server_fields(visit, frame);
}

template <class T>
concept HasFields = requires(Writer& writer, const T& value) {
  fields(writer, value);
};

}  // namespace

// nlohmann::json finds these two by the namespace of the value.
template <HasFields T>
static void to_json(Json& json, const T& value) {
  Writer writer{json};
  fields(writer, value);
}

template <HasFields T>
static void from_json(const Json& json, T& value) {
  Reader reader{json};
  fields(reader, value);
}

namespace io {

static void from_json(const Json& json, FrameResult& frame) {
  if (json.contains("status")) frame.server.emplace();
  bpa::from_json<FrameResult>(json, frame);
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
