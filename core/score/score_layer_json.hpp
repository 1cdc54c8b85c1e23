// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/status.hpp"
#include "core/score/score_layer.hpp"

namespace bpa {

/// The layers as JSON, each component by its name.
std::string to_json(const ScoreLayers& layers);

/// Fails with corrupt (naming `where` and what is wrong) on a text that is not JSON, is of another
/// version, lacks a layer or names an unknown score component. A component that a layer lacks adds
/// nothing to its log odds.
Result<ScoreLayers> score_layers_from_json(const std::string& text, const std::string& where);

}  // namespace bpa
