// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/align/correspondence.hpp"
#include "core/detect/search.hpp"

namespace bpa {

/// The oriented pair behind a candidate that a feature or a point pair suggested.
align::OrientedPair oriented_pair(const Search& search, const Candidate& candidate);

}  // namespace bpa
