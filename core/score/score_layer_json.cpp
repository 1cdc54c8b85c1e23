// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "core/score/score_layer.hpp"

namespace bpa::score {

// The text of config/score_layers.json when the library was built; CMakeLists.txt writes it.
extern const char* const kBuiltInLayers;

namespace {

constexpr int kVersion = 6;

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

// The place of a component in the table.
std::size_t index_of(const std::string& name) {
  const auto type = std::ranges::find(kScoreComponents, name, &ComponentType::name);
  if (type == kScoreComponents.end()) throw std::runtime_error("unknown component " + name);
  return static_cast<std::size_t>(type - kScoreComponents.begin());
}

ScoreLayer from_json(const nlohmann::json& json) {
  ScoreLayer layer;
  layer.bias = json.at("bias").get<double>();
  layer.provenance = json.at("provenance").get<std::string>();
  for (const auto& [name, curve] : json.at("components").items()) {
    ScoreLayer::Component& component = layer.components[index_of(name)];
    curve.at("place").get_to(component.place);
    curve.at("log_odds").get_to(component.value);
  }
  return layer;
}

// A limit of each name, one number for each level; names without a limit are left out.
nlohmann::ordered_json to_json(const LearnedLimits& learned, Limits LearnedLimits::Level::*of) {
  nlohmann::ordered_json out;
  for (const LearnedLimits::Level& level : learned.levels) {
    const Limits& limits = level.*of;
    for (std::size_t i = 0; i < kLimits; ++i) out[kLimitNames[i]].push_back(limits.stages[i]);
    for (std::size_t i = 0; i < kScoreComponents.size(); ++i) {
      const double limit = limits.components[i];
      if (std::isfinite(limit)) out["components"][kScoreComponents[i].name].push_back(limit);
    }
  }
  return out;
}

nlohmann::ordered_json to_json(const LearnedLimits& learned) {
  nlohmann::ordered_json out = {{"provenance", learned.provenance}};
  for (const auto& level : learned.levels) out["keep_right"].push_back(level.keep_right);
  out["with_color"] = to_json(learned, &LearnedLimits::Level::with_color);
  out["without_color"] = to_json(learned, &LearnedLimits::Level::without_color);
  return out;
}

void from_json(const nlohmann::json& json, LearnedLimits& learned,
               Limits LearnedLimits::Level::*of) {
  for (std::size_t level = 0; level < learned.levels.size(); ++level) {
    Limits& limits = learned.levels[level].*of;
    limits = Limits::none();
    for (std::size_t i = 0; i < kLimits; ++i) {
      limits.stages[i] = json.at(std::string(kLimitNames[i])).at(level).get<double>();
    }
    for (const auto& [name, values] : json.at("components").items()) {
      limits.components[index_of(name)] = values.at(level).get<double>();
    }
  }
}

LearnedLimits limits_from_json(const nlohmann::json& json) {
  LearnedLimits learned;
  learned.provenance = json.at("provenance").get<std::string>();
  for (const double keep_right : json.at("keep_right").get<std::vector<double>>()) {
    const double before = learned.levels.empty() ? 0 : learned.levels.back().keep_right;
    if (!(keep_right > before && keep_right < 1)) {
      throw std::runtime_error("keep_right must rise and be between 0 and 1");
    }
    learned.levels.push_back({keep_right, {}, {}});
  }
  if (learned.levels.empty()) throw std::runtime_error("keep_right is empty");
  from_json(json.at("with_color"), learned, &LearnedLimits::Level::with_color);
  from_json(json.at("without_color"), learned, &LearnedLimits::Level::without_color);
  return learned;
}

constexpr std::pair<const char*, double SearchYield::*> kYieldNumbers[] = {
    {"shape", &SearchYield::shape},
    {"tries", &SearchYield::tries},
    {"visible", &SearchYield::visible},
    {"objects", &SearchYield::objects},
    {"scenes", &SearchYield::scenes}};

nlohmann::ordered_json to_json(const SearchYield& yield) {
  nlohmann::ordered_json out;
  for (const auto& [name, number] : kYieldNumbers) out[name] = yield.*number;
  return out;
}

SearchYield yield_from_json(const nlohmann::json& json) {
  SearchYield out;
  for (const auto& [name, number] : kYieldNumbers) json.at(name).get_to(out.*number);
  if (!out.is_valid()) throw std::runtime_error("the yield's numbers must be over 0");
  return out;
}

}  // namespace

std::string to_json(const ScoreLayers& layers) {
  const nlohmann::ordered_json json = {{"score_layer_version", kVersion},
                                       {"round_two", to_json(layers.round_two)},
                                       {"round_three", to_json(layers.round_three)},
                                       {"without_color", to_json(layers.without_color)},
                                       {"limits", to_json(layers.limits)},
                                       {"yield",
                                        {{"provenance", layers.yield.provenance},
                                         {"with_color", to_json(layers.yield.with_color)},
                                         {"without_color", to_json(layers.yield.without_color)}}}};
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
    return ScoreLayers{from_json(json.at("round_two")),
                       from_json(json.at("round_three")),
                       from_json(json.at("without_color")),
                       limits_from_json(json.at("limits")),
                       {yield_from_json(json.at("yield").at("with_color")),
                        yield_from_json(json.at("yield").at("without_color")),
                        json.at("yield").at("provenance").get<std::string>()}};
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

}  // namespace bpa::score
