// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/log_filter.hpp"

#include <gtest/gtest.h>

#include "core/base/concat.hpp"

namespace bpa::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const LogFilter::TimePoint kStart{std::chrono::hours(1)};

std::optional<std::string> pass(LogFilter& filter, LogLevel level, const std::string& text,
                                LogFilter::TimePoint now, const std::string& peer = "") {
  return filter.pass(level, {text, SourceLocation::current(), peer}, now);
}

TEST(Printable, OneLineForATerminal) {
  EXPECT_EQ(printable("plain text, \"quoted\" \\ 100 %"), "plain text, \"quoted\" \\ 100 %");
  EXPECT_EQ(printable("a\nb\tc\r"), "a\\nb\\tc\\x0d");
  EXPECT_EQ(printable("\x1b[2J\x7f"), "\\x1b[2J\\x7f");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("gr\xc3\xbc\xc3\x9f \xe2\x82\xac \xf0\x9f\x98\x80"),
            "gr\xc3\xbc\xc3\x9f \xe2\x82\xac \xf0\x9f\x98\x80");
  EXPECT_EQ(printable("\xc2\x9b[2J"), "\\xc2\\x9b[2J");              // C1: the same as \x1b[
  EXPECT_EQ(printable("\xff\xc3\xc0\xaf"), "\\xff\\xc3\\xc0\\xaf");  // no UTF-8
  EXPECT_EQ(printable("\xe0\x82\x9b"), "\\xe0\\x82\\x9b");           // overlong C1
  EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82");                    // cut short
  EXPECT_EQ(printable(std::string(70'000, 'x')), std::string(1000, 'x') + "... (70000 bytes)");
  EXPECT_LT(printable(std::string(70'000, '\n')).size(), 1030U);
}

TEST(LogFilter, AFloodOfOneCauseIsCountedAndHidesNoOther) {
  LogFilter filter;
  int passed = 0;
  for (int i = 0; i < 30'000; ++i) {  // in 15 s
    const auto now = kStart + milliseconds(i / 2);
    passed += pass(filter, LogLevel::info, concat("detect refused: no model x", i), now) ? 1 : 0;
  }
  EXPECT_EQ(passed, 10 + 7);
  EXPECT_TRUE(pass(filter, LogLevel::info, "library l: 3 models", kStart + seconds(15)));
  EXPECT_TRUE(filter.left_out(kStart + seconds(16)).empty());
  const auto lines = filter.left_out(kStart + seconds(20));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("detect refused"), std::string::npos) << lines[0];
  EXPECT_TRUE(filter.left_out(kStart + seconds(21)).empty());
}

TEST(LogFilter, AFloodOfOneClientHidesNoOther) {
  LogFilter filter;
  const std::string text = "detect refused: no model x";
  for (int i = 0; i < 50; ++i) (void)pass(filter, LogLevel::info, text, kStart, "01.0f.aa");
  EXPECT_FALSE(pass(filter, LogLevel::info, text, kStart, "01.0f.aa"));
  EXPECT_EQ(pass(filter, LogLevel::info, text, kStart, "01.0f.bb"), text);
  const auto lines = filter.left_out(kStart + seconds(6));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0], "41 messages caused by 01.0f.aa were not logged: detect refused ...");
}

TEST(LogFilter, WhatPassesSaysHowManyDidNot) {
  LogFilter filter;
  for (int i = 0; i < 15; ++i) (void)pass(filter, LogLevel::error, "disk: full", kStart);
  const auto line = pass(filter, LogLevel::error, "disk: full", kStart + seconds(2));
  EXPECT_EQ(line, "disk: full (5 like it before were not logged)");
}

TEST(LogFilter, AllCausesTogetherAreLimited) {
  LogFilter filter;
  int passed = 0;
  std::uint64_t left_out = 0;
  for (int i = 0; i < 10'000; ++i) {
    const std::string cause(1 + i % 70, static_cast<char>('a' + i / 70 % 26));
    const auto line = pass(filter, LogLevel::info, cause, kStart + milliseconds(i / 10));
    if (!line) continue;
    ++passed;
    const std::size_t count = line->find(" (");
    if (count != std::string::npos) left_out += std::stoull(line->substr(count + 2));
  }
  EXPECT_GE(passed, 240);
  EXPECT_LE(passed, 250);
  for (const std::string& line : filter.left_out(kStart + seconds(60))) {
    left_out += std::stoull(line);
  }
  EXPECT_EQ(left_out, 10'000U - static_cast<std::uint64_t>(passed));
}

TEST(LogFilter, DebugMessagesPass) {
  LogFilter filter;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(pass(filter, LogLevel::debug, "frame: 1\n", kStart), "frame: 1\\n");
  }
}

}  // namespace
}  // namespace bpa::server
