// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/json_file.hpp"
#include "core/io/results.hpp"

namespace bpa::io {
namespace {

constexpr const char* kFormat = "bpa results";
constexpr int kVersion = 1;

template <class Matrix>
Json matrix_json(const Matrix& matrix) {  // row-major
  Json json = Json::array();
  for (int row = 0; row < matrix.rows(); ++row) {
    for (int col = 0; col < matrix.cols(); ++col) json.push_back(matrix(row, col));
  }
  return json;
}

template <class Matrix>
void matrix_from_json(const Json& json, Matrix& matrix) {
  for (int i = 0; i < static_cast<int>(matrix.size()); ++i) {
    matrix(i / static_cast<int>(matrix.cols()), i % static_cast<int>(matrix.cols())) =
        json.at(static_cast<std::size_t>(i)).template get<double>();
  }
}

Json placement_json(const ResultPlacement& placement) {
  Json components = Json::object();
  for (const ResultComponent& part : placement.components) components[part.name] = part.value;
  Json alternatives = Json::array();
  for (const ResultAlternative& other : placement.alternatives) {
    alternatives.push_back(
        {{"pose", pose_to_json(other.camera_from_object)}, {"weight", other.weight}});
  }
  return {{"obj_id", placement.obj_id},
          {"model", placement.model},
          {"pose", pose_to_json(placement.camera_from_object)},
          {"covariance", matrix_json(placement.covariance)},
          {"bingham",
           {{"axes", matrix_json(placement.orientation_axes)},
            {"concentrations", matrix_json(placement.orientation_concentrations)}}},
          {"score", placement.score},
          {"probability", placement.probability},
          {"visible_fraction", placement.visible_fraction},
          {"components", components},
          {"alternatives", alternatives}};
}

ResultPlacement placement_from_json(const Json& json) {
  ResultPlacement placement;
  placement.obj_id = json.at("obj_id").get<int>();
  placement.model = json.value("model", "");
  placement.camera_from_object = pose_from_json(json.at("pose"));
  if (json.contains("covariance")) matrix_from_json(json.at("covariance"), placement.covariance);
  if (json.contains("bingham")) {
    matrix_from_json(json.at("bingham").at("axes"), placement.orientation_axes);
    matrix_from_json(json.at("bingham").at("concentrations"), placement.orientation_concentrations);
  }
  placement.score = json.value("score", 0.0);
  placement.probability = json.at("probability").get<double>();
  placement.visible_fraction = json.value("visible_fraction", 0.0);
  if (json.contains("components")) {
    for (const auto& [name, value] : json.at("components").items()) {
      placement.components.push_back({name, value.get<double>()});
    }
  }
  if (json.contains("alternatives")) {
    for (const Json& other : json.at("alternatives")) {
      placement.alternatives.push_back(
          {pose_from_json(other.at("pose")), other.at("weight").get<double>()});
    }
  }
  return placement;
}

Json frame_json(const FrameResult& frame) {
  Json interpretations = Json::array();
  for (const ResultInterpretation& interpretation : frame.interpretations) {
    Json placements = Json::array();
    for (const ResultPlacement& p : interpretation.placements)
      placements.push_back(placement_json(p));
    interpretations.push_back({{"rank", interpretation.rank},
                               {"score", interpretation.score},
                               {"probability", interpretation.probability},
                               {"placements", placements}});
  }
  Json timings = Json::array();
  for (const ResultTiming& timing : frame.timings) {
    timings.push_back({{"stage", timing.stage}, {"milliseconds", timing.milliseconds}});
  }
  return {{"scene_id", frame.scene_id},
          {"im_id", frame.im_id},
          {"seconds", frame.seconds},
          {"budget_exhausted", frame.budget_exhausted},
          {"timings", timings},
          {"interpretations", interpretations},
          {"fused_frames", frame.fused_frames}};
}

FrameResult frame_from_json(const Json& json) {
  FrameResult frame;
  frame.scene_id = json.at("scene_id").get<int>();
  frame.im_id = json.at("im_id").get<int>();
  frame.seconds = json.at("seconds").get<double>();
  frame.budget_exhausted = json.value("budget_exhausted", false);
  frame.fused_frames = json.value("fused_frames", 1);
  if (json.contains("timings")) {
    for (const Json& timing : json.at("timings")) {
      frame.timings.push_back(
          {timing.at("stage").get<std::string>(), timing.at("milliseconds").get<double>()});
    }
  }
  for (const Json& item : json.at("interpretations")) {
    ResultInterpretation interpretation;
    interpretation.rank = item.at("rank").get<int>();
    interpretation.score = item.value("score", 0.0);
    interpretation.probability = item.value("probability", 0.0);
    for (const Json& placement : item.at("placements")) {
      interpretation.placements.push_back(placement_from_json(placement));
    }
    frame.interpretations.push_back(std::move(interpretation));
  }
  return frame;
}

}  // namespace

Status write_results_json(const std::string& path, const std::vector<FrameResult>& results) {
  Json frames = Json::array();
  for (const FrameResult& frame : results) frames.push_back(frame_json(frame));
  const Json json = {{"format", kFormat}, {"version", kVersion}, {"frames", frames}};
  return with_json(path, [&]() { return write_file(path, json.dump(1) + "\n"); });
}

Result<std::vector<FrameResult>> read_results_json(const std::string& path) {
  const Result<Json> json = read_json(path);
  if (!json.ok()) return json.status();
  return with_json(path, [&]() -> Result<std::vector<FrameResult>> {
    if (json->value("format", "") != kFormat || json->at("version").get<int>() != kVersion) {
      return Status(StatusCode::corrupt,
                    path + " is not a result file of version " + std::to_string(kVersion));
    }
    std::vector<FrameResult> results;
    for (const Json& frame : json->at("frames")) results.push_back(frame_from_json(frame));
    return results;
  });
}

}  // namespace bpa::io
