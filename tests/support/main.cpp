// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// main() of every test program. Exits 1 if a case failed, else 77 (CTest's "skipped") if a case was
// skipped, else 0. Prints a line "skipped: SUITE.CASE: REASON" for each skipped case.
#include <algorithm>
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

namespace {

constexpr int kSkipped = 77;  // SKIP_RETURN_CODE of tests/CMakeLists.txt

class SkipPrinter : public testing::EmptyTestEventListener {
  void OnTestEnd(const testing::TestInfo& test) override {
    const testing::TestResult& result = *test.result();
    for (int i = 0; result.Skipped() && i < result.total_part_count(); ++i) {
      if (!result.GetTestPartResult(i).skipped()) continue;
      std::string reason = result.GetTestPartResult(i).message();
      std::replace(reason.begin(), reason.end(), '\n', ' ');
      std::printf("skipped: %s.%s: %s\n", test.test_suite_name(), test.name(), reason.c_str());
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  testing::UnitTest& tests = *testing::UnitTest::GetInstance();
  tests.listeners().Append(new SkipPrinter);  // GoogleTest owns it
  if (RUN_ALL_TESTS() != 0) return 1;
  return tests.skipped_test_count() > 0 ? kSkipped : 0;
}
