// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/eval/pose_errors.hpp"

namespace bpa::eval {
namespace {

/// Pairs the rows, of which there are at most as many as columns, one after the other by shortest
/// augmenting paths over reduced costs (Jonker and Volgenant 1987). Indices count from 1: row and
/// column 0 stand for none. Returns the row of each column.
std::vector<int> rows_of_columns(int rows, int columns, const auto& cost) {
  std::vector<double> row_price(rows + 1, 0), column_price(columns + 1, 0);
  std::vector<int> row_of(columns + 1, 0), before(columns + 1, 0);
  for (int row = 1; row <= rows; ++row) {
    std::vector<double> shortest(columns + 1, std::numeric_limits<double>::infinity());
    std::vector<bool> done(columns + 1, false);
    int column = 0;
    row_of[0] = row;
    while (row_of[column] != 0) {
      done[column] = true;
      const int from = row_of[column];
      int next = 0;
      double step = std::numeric_limits<double>::infinity();
      for (int j = 1; j <= columns; ++j) {
        if (done[j]) continue;
        const double reduced = cost(from, j) - row_price[from] - column_price[j];
        if (reduced < shortest[j]) {
          shortest[j] = reduced;
          before[j] = column;
        }
        if (shortest[j] < step) {
          step = shortest[j];
          next = j;
        }
      }
      for (int j = 0; j <= columns; ++j) {
        if (done[j]) {
          row_price[row_of[j]] += step;
          column_price[j] -= step;
        } else {
          shortest[j] -= step;
        }
      }
      column = next;
    }
    for (; column != 0; column = before[column]) row_of[column] = row_of[before[column]];
  }
  return row_of;
}

}  // namespace

std::vector<int> assigned(const std::vector<std::vector<double>>& costs) {
  const int rows = static_cast<int>(costs.size());
  const int columns = rows > 0 ? static_cast<int>(costs.front().size()) : 0;
  double sum = 1;
  for (const auto& row : costs) {
    for (const double cost : row) sum += cost == kNoMatch ? 0 : std::abs(cost);
  }
  // Dearer than all others together, so that as few as possible are taken.
  const double dear = 2 * sum;
  const auto cost = [&](int row, int column) {
    const double given = costs[row - 1][column - 1];
    return given == kNoMatch ? dear : given;
  };
  const bool wide = rows <= columns;
  const std::vector<int> partner =
      wide ? rows_of_columns(rows, columns, cost)
           : rows_of_columns(columns, rows, [&](int column, int row) { return cost(row, column); });
  std::vector<int> result(rows, -1);
  for (int k = 1; k < static_cast<int>(partner.size()); ++k) {
    if (partner[k] == 0) continue;
    const int row = wide ? partner[k] : k, column = wide ? k : partner[k];
    if (costs[row - 1][column - 1] != kNoMatch) result[row - 1] = column - 1;
  }
  return result;
}

}  // namespace bpa::eval
