// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/options.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace bpa {
namespace {

struct Sample {
  double range_m = 2;
  int count = 3;
  bool on = true;

  template <class Visitor>
  void visit_fields(Visitor&& visit) {
    visit("range_m", range_m, FieldRule{0.1, 20, "How far."});
    visit("count", count, FieldRule{1, 10, "How many."});
    visit("on", on, FieldRule{0, 1, "Whether."});
  }
};

TEST(Options, DefaultsAreValid) { EXPECT_TRUE(validate(Sample{}).ok()); }

TEST(Options, NamesFieldValueAndRule) {
  Sample sample;
  sample.count = 11;
  EXPECT_EQ(validate(sample).message, "count is 11; it must be between 1 and 10");
}

TEST(Options, NotANumberIsOutOfRange) {
  Sample sample;
  sample.range_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(validate(sample).ok());
}

}  // namespace
}  // namespace bpa
