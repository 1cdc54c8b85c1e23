// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace bpa::eval {

/// One-to-one assignment of rows to columns (Kuhn 1955, Munkres 1957): of all that pair as many
/// rows as can be paired, one whose costs have the smallest sum. costs[row][column] is finite, or
/// kNoMatch where the two cannot be paired. Returns the column of each row, -1 for none.
std::vector<int> assigned(const std::vector<std::vector<double>>& costs);

}  // namespace bpa::eval
