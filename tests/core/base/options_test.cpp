// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/options.hpp"

#include <limits>
#include <type_traits>

#include <gtest/gtest.h>

namespace bpa {
namespace {

struct Limits {
  BPA_OPTION(double, range_m, 2, (0.1, 20), "How far.");
  double hidden = 7;
  BPA_OPTION(int, count, 3, (1, 10), "How many.");
  BPA_OPTION(bool, on, true, (), "Whether.");
};

struct Place {
  BPA_GROUP(Limits, near, "Close by.") = {0.5, 8, 2, false};
  BPA_OPTION(std::string, word, "one", ("one two "), "Which.");
};

struct Named {
  BPA_OPTION(std::vector<std::string>, list, {}, (), "Several.");
};

struct Whole : Named {
  BPA_GROUP(Limits, last, "Groups come after fields.");
  BPA_NAMED_OPTION("namespace", std::string, name, "/a", ().at_run_time(),
                   "A sentence of "
                   "two literals.");
  BPA_BASE_OPTIONS(Named);
  BPA_INLINE_GROUP(Place, place);
  BPA_OPTION(std::uint64_t, seed, 5, (0, 9).at_run_time(), "Seed.");
};

static_assert(std::is_aggregate_v<Limits> && std::is_aggregate_v<Whole>);
static_assert(sizeof(Place) == sizeof(Limits) + sizeof(std::string));

struct Expected {
  const char* path;
  const char* description;
  double min, max;
  bool runtime;
  const char* choices;
  void* value;
};

TEST(Options, AreListedInTheOrderOfTheirDeclarationsFieldsFirst) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Whole whole;
  const Expected expected[] = {
      {"namespace", "A sentence of two literals.", -kInf, kInf, true, "", &whole.name},
      {"list", "Several.", -kInf, kInf, false, "", &whole.list},
      {"word", "Which.", -kInf, kInf, false, "one two ", &whole.place.word},
      {"seed", "Seed.", 0, 9, true, "", &whole.seed},
      {"last", "Groups come after fields.", -kInf, kInf, false, "", nullptr},
      {"last.range_m", "How far.", 0.1, 20, false, "", &whole.last.range_m},
      {"last.count", "How many.", 1, 10, false, "", &whole.last.count},
      {"last.on", "Whether.", -kInf, kInf, false, "", &whole.last.on},
      {"near", "Close by.", -kInf, kInf, false, "", nullptr},
      {"near.range_m", "How far.", 0.1, 20, false, "", &whole.place.near.range_m},
      {"near.count", "How many.", 1, 10, false, "", &whole.place.near.count},
      {"near.on", "Whether.", -kInf, kInf, false, "", &whole.place.near.on}};
  const std::vector<Option> options = options_of(whole);
  ASSERT_EQ(options.size(), std::size(expected));
  for (std::size_t i = 0; i < options.size(); ++i) {
    const Option& option = options[i];
    EXPECT_EQ(option.path, expected[i].path);
    EXPECT_STREQ(option.description, expected[i].description) << option.path;
    EXPECT_EQ(option.rule.min, expected[i].min) << option.path;
    EXPECT_EQ(option.rule.max, expected[i].max) << option.path;
    EXPECT_EQ(option.rule.runtime, expected[i].runtime) << option.path;
    EXPECT_EQ(option.rule.choices, expected[i].choices) << option.path;
    EXPECT_EQ(option.is_group(), expected[i].value == nullptr) << option.path;
    std::visit(
        [&]<class Value>(Value value) {
          if constexpr (std::is_pointer_v<Value>) {
            EXPECT_EQ(value, expected[i].value) << option.path;
          }
        },
        option.value);
  }
}

TEST(Options, HaveTheDefaultsOfPlainMembers) {
  const Whole whole;
  EXPECT_EQ(whole.name, "/a");
  EXPECT_EQ(whole.seed, 5u);
  EXPECT_EQ(whole.last.count, 3);
  EXPECT_EQ(whole.place.near.count, 2);
  EXPECT_FALSE(whole.place.near.on);
  EXPECT_EQ((Limits{.hidden = 1, .count = 4}).count, 4);
}

TEST(Options, DefaultsAreValid) { EXPECT_TRUE(validate(Whole{}).ok()); }

TEST(Options, NamesFieldValueAndRule) {
  Limits limits;
  limits.count = 11;
  EXPECT_EQ(validate(limits).message, "count is 11; it must be between 1 and 10");
}

TEST(Options, NamesTheChoicesOfAText) {
  Whole whole;
  whole.place.word = "on";
  EXPECT_EQ(validate(whole).message, "word is \"on\"; it must be one of one, two");
}

TEST(Options, NotANumberIsOutOfRange) {
  Limits limits;
  limits.range_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(validate(limits).ok());
}

}  // namespace
}  // namespace bpa
