// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace bpa {

/// The text of config/score_layers.json when the library was built.
extern const char* const kBuiltInLayers;

}  // namespace bpa
