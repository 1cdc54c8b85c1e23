// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/detect/search.hpp"

namespace bpa {

/// The best placements of one model in the scene (paper section V), best first. Deterministic
/// unless the search's deadline passes: then the best so far. `trace`, if given, receives each
/// stage.
Candidates detect_object(Search search, ObjectTrace* trace = nullptr);

}  // namespace bpa
