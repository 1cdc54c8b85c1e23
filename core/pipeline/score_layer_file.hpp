// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <bpa/core/base/status.hpp>
#include <bpa/core/score/score_layer.hpp>

namespace bpa {

/// The file of a library's own score layer: "FOLDER/score_layer.json".
std::string score_layer_path(const std::string& library_folder);

Status write_score_layer(const std::string& path, const ScoreLayer& layer);
/// Fails with not_found, or with corrupt (naming the file and what is wrong) on a file that is not
/// JSON, is of another version, or lacks a score component.
Result<ScoreLayer> read_score_layer(const std::string& path);
/// The layer of the library, or default_score_layer() where the library has none of its own.
Result<ScoreLayer> library_score_layer(const std::string& library_folder);

}  // namespace bpa
