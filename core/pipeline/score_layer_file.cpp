// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/score_layer_file.hpp"

#include <algorithm>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "core/io/file_bytes.hpp"

namespace bpa {
namespace {

constexpr int kVersion = 4;

Status corrupt(const std::string& path, const std::string& what) {
  return Status(StatusCode::corrupt, path + ": " + what);
}

nlohmann::ordered_json to_json(const ScoreLayer& layer) {
  nlohmann::ordered_json components;
  for (std::size_t i = 0; i < kScoreComponents.size(); ++i) {
    if (!kScoreComponents[i].learned) continue;
    const ScoreLayer::Component& c = layer.components[i];
    components[kScoreComponents[i].name] = {{"place", c.place}, {"log_odds", c.value}};
  }
  return {{"provenance", layer.provenance}, {"bias", layer.bias}, {"components", components}};
}

ScoreLayer from_json(const nlohmann::json& json) {
  ScoreLayer layer;
  layer.bias = json.at("bias").get<double>();
  layer.provenance = json.at("provenance").get<std::string>();
  for (const auto& [name, curve] : json.at("components").items()) {
    const auto type = std::find_if(kScoreComponents.begin(), kScoreComponents.end(),
                                   [&](const ComponentType& t) { return t.name == name; });
    if (type == kScoreComponents.end()) throw std::runtime_error("unknown component " + name);
    ScoreLayer::Component& component =
        layer.components[static_cast<std::size_t>(type - kScoreComponents.begin())];
    curve.at("place").get_to(component.place);
    curve.at("log_odds").get_to(component.value);
  }
  return layer;
}

}  // namespace

std::string score_layer_path(const std::string& library_folder) {
  return library_folder + "/score_layer.json";
}

Status write_score_layers(const std::string& path, const ScoreLayers& layers) {
  const nlohmann::ordered_json json = {{"score_layer_version", kVersion},
                                       {"round_two", to_json(layers.round_two)},
                                       {"round_three", to_json(layers.round_three)},
                                       {"without_color", to_json(layers.without_color)}};
  return io::write_file(path, json.dump(2) + "\n");
}

Result<ScoreLayers> read_score_layers(const std::string& path) {
  const Result<std::string> bytes = io::read_file(path);
  if (!bytes.ok()) return bytes.status();
  const auto json = nlohmann::json::parse(*bytes, nullptr, false);
  if (json.is_discarded()) return corrupt(path, "truncated or not JSON");
  try {
    const int version = json.at("score_layer_version").get<int>();
    if (version != kVersion) {
      return corrupt(path, "holds score layers of version " + std::to_string(version) +
                               "; this program reads version " + std::to_string(kVersion) +
                               ": run 'bpa train' again");
    }
    return ScoreLayers{from_json(json.at("round_two")), from_json(json.at("round_three")),
                       from_json(json.at("without_color"))};
  } catch (const std::exception& error) {
    return corrupt(path, std::string("does not have the expected content: ") + error.what());
  }
}

Result<ScoreLayers> library_score_layers(const std::string& library_folder) {
  Result<ScoreLayers> layers = read_score_layers(score_layer_path(library_folder));
  if (!layers.ok() && layers.status().code == StatusCode::not_found) return default_score_layers();
  return layers;
}

}  // namespace bpa
