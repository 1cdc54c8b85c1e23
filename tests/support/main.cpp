// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// main() of every test program. --files=A,B runs the cases of these source files alone. Exits 1 if
// a case failed, else 77 (CTest's "skipped") if a case was skipped, else 0. Prints a line "skipped:
// SUITE.CASE: REASON" for each skipped case.
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

// The filter for the cases of source files, named without their folders and joined by commas.
std::string filter_of(const std::string& files) {
  std::string filter;
  const testing::UnitTest& tests = *testing::UnitTest::GetInstance();
  for (int s = 0; s < tests.total_test_suite_count(); ++s) {
    const testing::TestSuite& suite = *tests.GetTestSuite(s);
    for (int i = 0; i < suite.total_test_count(); ++i) {
      const testing::TestInfo& test = *suite.GetTestInfo(i);
      const std::string path = test.file(), name = path.substr(path.rfind('/') + 1);
      if (("," + files + ",").find("," + name + ",") == std::string::npos) continue;
      filter += std::string(suite.name()) + "." + test.name() + ":";
    }
  }
  return filter;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  testing::UnitTest& tests = *testing::UnitTest::GetInstance();
  const std::string option = "--files=";
  if (argc > 1 && std::string(argv[1]).rfind(option, 0) == 0) {
    const std::string filter = filter_of(argv[1] + option.size());
    if (filter.empty()) {
      std::printf("%s names no file with cases\n", argv[1]);
      return 1;
    }
    testing::GTEST_FLAG(filter) = filter;
  }
  tests.listeners().Append(new SkipPrinter);  // GoogleTest owns it
  if (RUN_ALL_TESTS() != 0) return 1;
  return tests.skipped_test_count() > 0 ? kSkipped : 0;
}
