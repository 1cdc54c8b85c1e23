// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/doctor/result_check.hpp"

#include <gtest/gtest.h>

namespace bpa::doctor {
namespace {

TEST(ResultCheck, EmptyAndDoubtfulResultsSayLittle) {
  SceneInterpretations result;
  EXPECT_TRUE(says_little(result));
  result.interpretations.resize(2);
  EXPECT_TRUE(says_little(result));
  Placement placement;
  placement.presence = 0.9;
  result.interpretations[1].placements = {placement};
  EXPECT_TRUE(says_little(result));  // the best one counts
  placement.presence = 0.4;
  result.interpretations[0].placements = {placement};
  EXPECT_TRUE(says_little(result));
  placement.presence = 0.6;
  result.interpretations[0].placements.push_back(placement);
  EXPECT_FALSE(says_little(result));
}

TEST(ResultCheck, FindingsAreLinesTheWorstFirst) {
  EXPECT_EQ(lines_of({}), "");
  EXPECT_EQ(lines_of({{Severity::warning, "dark", "it is 3", "Add light."},
                      {Severity::error, "unit", "it is 7 m", "Correct it."},
                      {Severity::warning, "far", "9 m", "Go near."}}),
            "unit: it is 7 m. Correct it.\ndark: it is 3. Add light.\nfar: 9 m. Go near.");
}

}  // namespace
}  // namespace bpa::doctor
