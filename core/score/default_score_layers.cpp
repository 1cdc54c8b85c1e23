// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cassert>

#include "core/score/built_in_layers.hpp"
#include "core/score/score_layer_json.hpp"

namespace bpa {

const ScoreLayers& default_score_layers() {
  static const ScoreLayers layers = [] {
    Result<ScoreLayers> read = score_layers_from_json(kBuiltInLayers, "the built-in score layers");
    assert(read.ok());
    return *read;
  }();
  return layers;
}

}  // namespace bpa
