# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Checks skips.py on what ctest itself writes, and its list on the tests' sources."""

import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import skips

SCRIPT = Path(skips.__file__).resolve()
# Four tests of CTest: one passes, one skips a case, one skips as a whole, one fails after a skip.
TESTS = """
add_test(a/passes sh -c "echo skipped: A.Talks: of skips")
add_test(a/skips sh -c "echo a; echo 'skipped: A.NoData: no frames'; seq 2000; exit 77")
add_test(a/tool sh -c "echo 'no tool'; exit 77")
add_test(a/fails sh -c "echo 'skipped: A.Other: no'; exit 1")
set_tests_properties(a/passes a/skips a/tool a/fails PROPERTIES SKIP_RETURN_CODE 77)
"""


class Skips(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "CTestTestfile.cmake").write_text(TESTS, encoding="utf-8")
        self.ctest = subprocess.run(
            ["ctest", "--output-junit", "junit.xml"], cwd=self.root, capture_output=True, text=True)

    def run_script(self, **environment):
        inherited = {name: value for name, value in os.environ.items()
                     if name not in ("BPA_EXPECTED_SKIPS", "BPA_DATA")}
        return subprocess.run([sys.executable, "-B", SCRIPT, self.root / "junit.xml"],
                              env={**inherited, **environment}, capture_output=True, text=True)

    def test_a_failure_after_a_skip_is_a_failure(self):
        self.assertIn("1 tests failed out of 4", self.ctest.stdout)

    def test_a_skip_is_printed_with_its_reason_and_fails(self):
        result = self.run_script(BPA_EXPECTED_SKIPS="a/tool")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(result.stdout.splitlines(), [
            "2 skipped, 1 of them not expected",
            "  A.NoData (not expected): no frames", "  a/tool: no tool"])

    def test_expected_skips_pass(self):
        result = self.run_script(BPA_EXPECTED_SKIPS="a/tool A.NoData")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_the_data_folder_decides_what_is_expected(self):
        self.assertEqual(skips.expected({"BPA_DATA": str(self.root)}, self.root),
                         skips.REAL_FRAMES)
        (self.root / "ycbv").mkdir()
        self.assertEqual(skips.expected({"BPA_DATA": str(self.root)}, self.root), ())

    def test_the_list_names_the_cases_that_may_skip_for_want_of_data(self):
        named = []
        for path in SCRIPT.parents[1].rglob("*_test.cpp"):
            for case in re.split(r"^TEST(?:_F|_P)?\(", path.read_text(encoding="utf-8"),
                                 flags=re.MULTILINE)[1:]:
                if re.search(r"(BPA_DATA|real_data\(\)).*GTEST_SKIP", case, flags=re.DOTALL):
                    named.append(".".join(re.match(r"(\w+),\s*(\w+)\)", case).groups()))
        self.assertEqual(sorted(named), sorted(skips.REAL_FRAMES))


if __name__ == "__main__":
    unittest.main()
