// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/score_layer_file.hpp"

#include "core/io/file_bytes.hpp"

namespace bpa {

std::string score_layer_path(const std::string& library_folder) {
  return library_folder + "/score_layer.json";
}

Status write_score_layers(const std::string& path, const ScoreLayers& layers) {
  return io::write_file(path, to_json(layers));
}

Result<ScoreLayers> read_score_layers(const std::string& path) {
  const Result<std::string> bytes = io::read_file(path);
  if (!bytes.ok()) return bytes.status();
  return score_layers_from_json(*bytes, path);
}

Result<ScoreLayers> library_score_layers(const std::string& library_folder) {
  Result<ScoreLayers> layers = read_score_layers(score_layer_path(library_folder));
  if (!layers.ok() && layers.status().code == StatusCode::not_found) return default_score_layers();
  return layers;
}

}  // namespace bpa
