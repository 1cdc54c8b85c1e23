// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/status.hpp"
#include "core/score/score_layer.hpp"

namespace bpa {

/// The file of a library's own score layers: "FOLDER/score_layer.json".
std::string score_layer_path(const std::string& library_folder);

Status write_score_layers(const std::string& path, const ScoreLayers& layers);
/// Fails with not_found, or as score_layers_from_json().
Result<ScoreLayers> read_score_layers(const std::string& path);
/// The layers of the library, or default_score_layers() where the library has none of its own.
Result<ScoreLayers> library_score_layers(const std::string& library_folder);

}  // namespace bpa
