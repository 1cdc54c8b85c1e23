// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include <bpa/core/io/file_bytes.hpp>
#include <bpa/core/pipeline/score_layer_file.hpp>

namespace bpa {
namespace {

constexpr int kVersion = 2;

Status corrupt(const std::string& path, const std::string& what) {
  return Status(StatusCode::corrupt, path + ": " + what);
}

}  // namespace

std::string score_layer_path(const std::string& library_folder) {
  return library_folder + "/score_layer.json";
}

Status write_score_layer(const std::string& path, const ScoreLayer& layer) {
  nlohmann::ordered_json components;
  for (std::size_t i = 0; i < kNumScoreFeatures; ++i) {
    const ScoreLayer::Component& c = layer.components[i];
    components[score_feature_names()[i]] = {{"place", c.place}, {"log_odds", c.value}};
  }
  const nlohmann::ordered_json json = {{"score_layer_version", kVersion},
                                       {"provenance", layer.provenance},
                                       {"bias", layer.bias},
                                       {"components", components}};
  return io::write_file(path, json.dump(2) + "\n");
}

Result<ScoreLayer> read_score_layer(const std::string& path) {
  const Result<std::string> bytes = io::read_file(path);
  if (!bytes.ok()) return bytes.status();
  const auto json = nlohmann::json::parse(*bytes, nullptr, false);
  if (json.is_discarded()) return corrupt(path, "truncated or not JSON");
  try {
    const int version = json.at("score_layer_version").get<int>();
    if (version != kVersion) {
      return corrupt(path, "is a score layer of version " + std::to_string(version) +
                               "; this program reads version " + std::to_string(kVersion) +
                               ": run 'bpa train' again");
    }
    ScoreLayer layer;
    layer.bias = json.at("bias").get<double>();
    layer.provenance = json.at("provenance").get<std::string>();
    for (std::size_t i = 0; i < kNumScoreFeatures; ++i) {
      const auto& entry = json.at("components").at(score_feature_names()[i]);
      entry.at("place").get_to(layer.components[i].place);
      entry.at("log_odds").get_to(layer.components[i].value);
    }
    return layer;
  } catch (const nlohmann::json::exception& error) {
    return corrupt(path, std::string("does not have the expected content: ") + error.what());
  }
}

Result<ScoreLayer> library_score_layer(const std::string& library_folder) {
  Result<ScoreLayer> layer = read_score_layer(score_layer_path(library_folder));
  if (!layer.ok() && layer.status().code == StatusCode::not_found) return default_score_layer();
  return layer;
}

}  // namespace bpa
