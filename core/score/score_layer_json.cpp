// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "core/score/score_layer.hpp"

namespace bpa {

// The text of config/score_layers.json when the library was built; CMakeLists.txt writes it.
extern const char* const kBuiltInLayers;

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
                                   [&key = name](const ComponentType& t) { return t.name == key; });
    if (type == kScoreComponents.end()) throw std::runtime_error("unknown component " + name);
    ScoreLayer::Component& component =
        layer.components[static_cast<std::size_t>(type - kScoreComponents.begin())];
    curve.at("place").get_to(component.place);
    curve.at("log_odds").get_to(component.value);
  }
  return layer;
}

}  // namespace

std::string to_json(const ScoreLayers& layers) {
  const nlohmann::ordered_json json = {{"score_layer_version", kVersion},
                                       {"round_two", to_json(layers.round_two)},
                                       {"round_three", to_json(layers.round_three)},
                                       {"without_color", to_json(layers.without_color)}};
  return json.dump(1) + "\n";
}

Result<ScoreLayers> score_layers_from_json(const std::string& text, const std::string& where) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) return corrupt(where, "truncated or not JSON");
  try {
    const int version = json.at("score_layer_version").get<int>();
    if (version != kVersion) {
      return corrupt(where, "holds score layers of version " + std::to_string(version) +
                                "; this program reads version " + std::to_string(kVersion) +
                                ": run 'bpa train' again");
    }
    return ScoreLayers{from_json(json.at("round_two")), from_json(json.at("round_three")),
                       from_json(json.at("without_color"))};
  } catch (const std::exception& error) {
    return corrupt(where, std::string("does not have the expected content: ") + error.what());
  }
}

const ScoreLayers& default_score_layers() {
  static const ScoreLayers layers = [] {
    Result<ScoreLayers> read = score_layers_from_json(kBuiltInLayers, "the built-in score layers");
    assert(read.ok());
    return *read;
  }();
  return layers;
}

}  // namespace bpa
