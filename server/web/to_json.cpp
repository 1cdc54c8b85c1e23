// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/to_json.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/concat.hpp"
#include "core/draw/annotate.hpp"
#include "server/convert/results.hpp"
#include "server/parameters.hpp"
#include "server/web/json_text.hpp"

namespace bpa::server::web {
namespace {

using Json = nlohmann::json;
using wire::rcl_interfaces::Parameter;
using wire::rcl_interfaces::ParameterDescriptor;
using wire::rcl_interfaces::ParameterType;
using wire::rcl_interfaces::ParameterValue;

/// Points of a model in the 3-D view, 0.2 MB: dense enough to read print on a box.
constexpr std::size_t kSurfacePoints = 12000;
constexpr float kSameSide = 0.5f;  ///< Cosine of normals.

Json values_json(const std::vector<wire::diagnostic_msgs::KeyValue>& values) {
  Json json = Json::array();
  for (const auto& value : values) json.push_back({value.key, value.value});
  return json;
}

/// Calls visit(value) for the one value that a parameter of this type has.
void visit_value(std::uint8_t type, auto& value, const auto& visit) {
  if (type == ParameterType::kBool) visit(value.bool_value);
  if (type == ParameterType::kInteger) visit(value.integer_value);
  if (type == ParameterType::kDouble) visit(value.double_value);
  if (type == ParameterType::kString) visit(value.string_value);
  if (type == ParameterType::kStringArray) visit(value.string_array_value);
}

Json value_json(const ParameterValue& value) {
  Json json;
  visit_value(value.type, value, [&json](const auto& one) { json = one; });
  return json;
}

Json range_json(const ParameterDescriptor& about) {
  if (!about.integer_range.empty()) {
    return {about.integer_range[0].from_value, about.integer_range[0].to_value};
  }
  if (!about.floating_point_range.empty()) {
    return {about.floating_point_range[0].from_value, about.floating_point_range[0].to_value};
  }
  return nullptr;
}

const char* origin_text(SymmetryOrigin origin) {
  if (origin == SymmetryOrigin::declared) return "declared";
  return origin == SymmetryOrigin::found ? "found in the surface, not confirmed" : "not searched";
}

Json xyz_json(const auto& v) { return {v.x, v.y, v.z}; }

Json model_json(const ObjectModel& model) {
  const wire::bpa_msgs::ModelInfo info = model_message(model);
  Json axes = Json::array(), turns = Json::array();
  for (const auto& symmetry : info.continuous_symmetries) axes.push_back(xyz_json(symmetry.axis));
  for (const auto& pose : info.discrete_symmetries) {
    const auto& q = pose.orientation;
    turns.push_back({q.w, q.x, q.y, q.z});
  }
  const draw::Rgb color = draw::object_color(model.number);
  return {{"name", info.name},
          {"number", info.number},
          {"diameter", info.diameter},
          {"box_min", xyz_json(info.box_min)},
          {"box_max", xyz_json(info.box_max)},
          {"points", info.point_count},
          {"has_colors", !model.surface.colors.empty()},
          {"complete", model.complete},
          {"source", model.source},
          {"color", {color[0], color[1], color[2]}},
          {"symmetry_origin", origin_text(model.symmetry_origin)},
          {"symmetry_axes", axes},
          {"symmetry_turns_wxyz", turns},
          {"warnings", model.warnings}};
}

}  // namespace

std::string status_json(const wire::bpa_msgs::GetStatus_Response& status) {
  constexpr const char* kStates[] = {"running", "paused", "idle"};
  using S = wire::bpa_msgs::GetStatus_Response;
  const char* state = kStates[status.state == S::kPaused ? 1 : status.state == S::kIdle ? 2 : 0];
  return json_text({{"version", status.version},
                    {"state", state},
                    {"uptime_s", status.uptime_s},
                    {"frames_received", status.frames_received},
                    {"frames_processed", status.frames_processed},
                    {"frames_dropped", status.frames_dropped},
                    {"frames_rejected", status.frames_rejected},
                    {"requests_served", status.requests_served},
                    {"requests_refused", status.requests_refused},
                    {"queue_length", status.queue_length},
                    {"queue_capacity", status.queue_capacity},
                    {"model_count", status.model_count},
                    {"library", status.library},
                    {"database_version", status.database_version},
                    {"memory_bytes", status.memory_bytes}});
}

std::string diagnostics_json(const wire::diagnostic_msgs::DiagnosticArray& diagnostics) {
  Json json = Json::array();
  for (const auto& status : diagnostics.status) {
    json.push_back({{"name", status.name},
                    {"level", static_cast<int>(status.level)},
                    {"message", status.message},
                    {"hardware_id", status.hardware_id},
                    {"values", values_json(status.values)}});
  }
  return json_text(json);
}

std::string log_json(const std::vector<RecentLog::Line>& lines) {
  constexpr const char* kLevels[] = {"debug", "info", "warning", "error"};
  Json json = Json::array();
  for (const RecentLog::Line& line : lines) {
    json.push_back({{"id", line.id},
                    {"stamp_ns", line.stamp_ns},
                    {"level", kLevels[static_cast<std::size_t>(line.level)]},
                    {"text", line.text}});
  }
  return json_text(json);
}

std::string parameters_json(const ServerOptions& options) {
  const std::vector<Parameter> now = all_parameters(options);
  const std::vector<Parameter> defaults = all_parameters(ServerOptions());
  Json json = Json::array();
  for (std::size_t i = 0; i < now.size(); ++i) {
    const ParameterDescriptor about = describe_parameter(now[i].name);
    json.push_back({{"name", now[i].name},
                    {"type", type_name(about.type)},
                    {"value", value_json(now[i].value)},
                    {"default", value_json(defaults[i].value)},
                    {"range", range_json(about)},
                    {"description", about.description},
                    {"read_only", about.read_only}});
  }
  return json_text(json);
}

Result<Parameter> parameter_from_json(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("name") || !json["name"].is_string() ||
      !json.contains("value")) {
    return invalid_argument(
        "the body must be JSON like {\"name\": \"detection.top_k\", \"value\": 5}");
  }
  Parameter parameter;
  parameter.name = json["name"].get<std::string>();
  const std::uint8_t type = describe_parameter(parameter.name).type;
  if (type == ParameterType::kNotSet) return not_found("there is no parameter ", parameter.name);
  try {
    parameter.value.type = type;
    visit_value(type, parameter.value, [&](auto& value) { json["value"].get_to(value); });
  } catch (const Json::exception&) {
    return invalid_argument(parameter.name, " is of type ", json["value"].type_name(),
                            "; it must be of type ", type_name(type));
  }
  return parameter;
}

std::string models_json(const Recognition& recognition, const std::vector<std::string>& in_folder) {
  const Models models = recognition.models();
  Json loaded = Json::array(), others = Json::array(), broken = Json::array();
  for (const auto& model : models) loaded.push_back(model_json(*model));
  for (const io::BrokenModel& model : recognition.broken()) {
    broken.push_back({{"name", model.name}, {"why", model.reason.message}});
  }
  for (const std::string& name : in_folder) {
    const auto has_name = [&](const auto& model) { return model->name == name; };
    if (std::ranges::none_of(models, has_name)) others.push_back(name);
  }
  return json_text({{"library", recognition.library()},
                    {"version", recognition.version()},
                    {"models", loaded},
                    {"not_loaded", others},
                    {"broken", broken}});
}

std::string findings_json(const doctor::Findings& findings, bool running) {
  Json list = Json::array();
  for (const doctor::Finding& finding : findings) {
    list.push_back({{"what", finding.what}, {"why", finding.why}, {"remedy", finding.remedy}});
  }
  return json_text({{"running", running}, {"findings", list}});
}

std::string score_terms_json(const std::vector<ScoreTerm>& terms) {
  Json json = Json::array();
  for (const ScoreTerm& term : terms) {
    json.push_back({{"name", term.name},
                    {"value", term.value},
                    {"unit", term.unit},
                    {"adds", term.log_odds},
                    {"meaning", term.meaning}});
  }
  return json_text(json);
}

std::string surface_bytes(const ObjectModel& model) {
  const PointCloud& surface = model.surface;
  const std::size_t step = surface.size() / kSurfacePoints + 1;
  const draw::Rgb plain = draw::object_color(model.number);
  std::string points, colors, normals;
  std::uint32_t count = 0;
  const auto append = [](std::string& to, const auto& value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (std::size_t i = 0; i < surface.size(); i += step, ++count) {
    for (const float x : surface.points[i]) append(points, x);
    const auto& rgb = surface.colors.empty() ? plain : surface.colors[i];
    for (const std::uint8_t c : rgb) append(colors, c);
    for (const float x : surface.normals[i]) {
      append(normals, static_cast<std::int8_t>(std::lround(127 * x)));
    }
  }
  std::string bytes;
  append(bytes, count);
  append(bytes, mean_spacing(surface, kSameSide) * std::sqrt(static_cast<float>(step)));
  return bytes + points + colors + normals;
}

}  // namespace bpa::server::web
